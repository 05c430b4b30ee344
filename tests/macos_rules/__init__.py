"""The rules of macOS, forced on the programs that tests start."""
