"""Verbs that set a vehicle up: diagnosis, calibration, signing."""
