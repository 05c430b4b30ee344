"""The Log screen without its widgets: rows, filter, details, and the log of several sources joined."""
