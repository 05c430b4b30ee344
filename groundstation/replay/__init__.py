"""Replay of telemetry logs: an index of the file, and a station that is fed from it."""
