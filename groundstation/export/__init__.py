"""Writes telemetry logs as files of other programs: MCAP, CSV, GPX, KML, JSON lines, and a part as a log again.

To add or change:
- a format of `mavhelm export`: a class that fits `Exporter` (`groundstation/export/exporter.py`) in a module
  beside it; its row in `groundstation/export/table.py`, `FORMATS`.
"""
