"""Obstacles: what range sensors report, which of them fail, and how fast the rover may drive toward what they see.

To add or change:
- a message of range sensors: `vehicle/proximity/cones.py` parses it; its row is in `vehicle/commands/proximity.py`.
- how a sensor fails: `vehicle/proximity/source.py`, `RangeSource.find_fault`.
"""
