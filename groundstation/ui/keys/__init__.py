"""Keys and gamepads: the gate that lets them drive, and what is pressed.

To add or change:
- a condition of the program or terminal under which keys do not drive: `groundstation/ui/keys/gate_checks.py`: a
  field of `AppCondition`, its row in `GATE_CHECKS`; `groundstation/ui/app/app.py` fills the field.
"""
