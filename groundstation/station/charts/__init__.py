"""Recording of the fields that charts draw, and of the marks under their time axis.

To add or change:
- a ready view of the Charts screen, or a quantity that the station measures for it:
  `groundstation/station/charts/catalogue.py`, `READY_VIEWS` and `STATION_FIELDS` (filled in `desk.py` beside it).
"""
