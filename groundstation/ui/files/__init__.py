"""The Files screen without its widgets: the tree, what lies on this machine, transfers, removal and export."""
