"""The parameter protocol."""
