"""Base of all screens: their class, questions, list keys, files on this machine."""
