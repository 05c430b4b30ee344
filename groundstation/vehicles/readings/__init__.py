"""Readings that are computed from a vehicle's messages: latency, track, outputs, speed."""
