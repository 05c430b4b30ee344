"""Editing of parameters: values being typed, pending changes, checks, files."""
