"""Verbs of the command line: `groundstation param get`, each one thing with one vehicle, without a screen."""
