"""The terminal: Textual's driver for it, its bytes as keys, its output, tmux around it."""
