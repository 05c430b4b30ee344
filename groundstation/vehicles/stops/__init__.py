"""What stops a vehicle, and when: its settings and what they mean.

To add or change:
- a setting of another autopilot to read and warn of: `groundstation/vehicles/stops/ardupilot_checks.py` or
  `px4_checks.py`, of what flies `copter_checks.py`; another autopilot: its row in
  `groundstation/vehicles/stops/settings_check.py`, `SETTINGS` or `FLIGHT_SETTINGS`.
- what stops a vehicle, and when: `groundstation/vehicles/stops/rover_stops.py`, `ardupilot_stops.py`,
  `copter_stops.py` or `px4_stops.py`: a rule and its parameters; another autopilot: its row in
  `groundstation/vehicles/stops/stop_bounds.py`, `STOP_RULES`.
"""
