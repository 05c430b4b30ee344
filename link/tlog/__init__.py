"""Telemetry logs (tlog): the format, and a recorder that writes in a thread."""
