"""Calibration of a vehicle's sensors.

To add or change:
- a calibration: `groundstation/vehicles/calibration/calibration.py`, `KINDS`; its key in
  `groundstation/ui/setup/lists.py`; what the vehicle reports of it: a module beside `compass_calibration.py`.
"""
