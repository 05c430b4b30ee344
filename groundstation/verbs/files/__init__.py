"""Verbs for parameters, files and logs."""
