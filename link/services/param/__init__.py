"""Parameter protocol."""
