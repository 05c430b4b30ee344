"""The paths to one vehicle: its peers on all links of the station. One conversation goes over all of them at once.

To add or change:
- which path is the best: `groundstation/vehicles/paths/path.py`, `Path.cost`.
- which events are told once, though each path brings them: `groundstation/vehicles/paths/copies.py`, `TOLD`.
"""
