"""The path from MANUAL_CONTROL to the motors: demand, mixer, slew rate, and the last gate.

To add or change:
- an arrangement of wheels: `vehicle/drive/mixer.py`, `MIXERS`; its simulation in `vehicle/sim/chassis.py`, `CHASSIS`.
"""
