"""Verbs that run in the process of a station, for a shell that only prints."""
