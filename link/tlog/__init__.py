"""Telemetry logs (tlog): format, and a recorder that writes them in a thread."""
