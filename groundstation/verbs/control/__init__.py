"""Verbs that arm, drive and stop a vehicle, change its mode or restart it."""
