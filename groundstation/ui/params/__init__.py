"""The Parameters screen without its widgets."""
