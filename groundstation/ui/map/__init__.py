"""What the Map screen edits and shows, without widgets: plans, their fields, checks and geometry.

To add or change:
- a key of the Map screen: `groundstation/ui/map/keys.py`, and its handler: `groundstation/ui/map/screen.py`;
  `groundstation/ui/map/drive_keys.py` if it goes to the vehicle.
- a newer MAV_CMD in the Map screen: nothing by hand: `python -m dialects.command_params >
  groundstation/ui/map/plan/mission_commands.json`.
"""
