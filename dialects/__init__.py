"""The MAVLink dialect: messages, enums, modes and codec. The only package that imports pymavlink.

To add or change:
- a message of the rover dialect: `dialects/rover.xml`; a field that pymavlink's definition lacks:
  `dialects/additions.xml`.
- how a message is queued, limited, forwarded and logged: its row in `dialects/traits.py`, `TRAITS`; a message without
  a row is plain state.
- a kind of vehicle that keys drive: `dialects/kinds.py`: a row in `DRIVEN` with its modes, axes and limits; its type:
  `KINDS`; the names of its modes: `dialects/mode_tables.py`.
- a vehicle with other axes: `dialects/axes.py`, `AXIS_MAPS`; a frame of PX4: `PX4_FRAMES`.
"""
