"""Notes of the station: the operator's log and the events in its recording.

To add or change:
- what the station notes in its recording: `groundstation/station/notes/station_notes.py`; a new kind:
  ROVER_STATION_EVENT_KIND in `dialects/rover.xml` and `StationEventKind` in `dialects/enums.py`.
"""
