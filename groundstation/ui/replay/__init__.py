"""The Replay screen without its widgets."""
