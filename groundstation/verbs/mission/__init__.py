"""Verbs for missions, fences, rally points and destinations."""
