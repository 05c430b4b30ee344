"""Probes of what a vehicle understands: dialect, streams, signing."""
