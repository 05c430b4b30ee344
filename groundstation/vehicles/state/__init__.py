"""State of a vehicle, as its messages report it.

To add or change:
- how a message changes what the screen shows: `groundstation/vehicles/state/vehicle_state.py`; beside the state:
  `groundstation/vehicles/state/drive_readings.py`.
"""
