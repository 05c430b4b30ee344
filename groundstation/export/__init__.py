"""Writes telemetry logs as files of other programs: MCAP, CSV, GPX, KML, JSON lines, and a part as a log again."""
