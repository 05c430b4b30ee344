"""Verbs of shells and lines that run in a station, and messages that its role does not allow."""
