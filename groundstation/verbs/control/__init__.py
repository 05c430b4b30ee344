"""Verbs that arm, drive and stop a vehicle, change its mode or restart it.

To add or change:
- a key that a script of `mavhelm drive` may press: `groundstation/verbs/control/key_script.py`, `_PLAYED`, and
  what it does: `drive.py` beside it.
"""
