"""AUTO: which mission items are accepted, and how they are executed.

To add or change:
- a mission item: a DO item: `item` of its command's row; a NAV item: `vehicle/autonomy/mission/rules.py`,
  `MISSION_RULES`, and `vehicle/autonomy/mission/nav_items.py` or `executor.py`.
"""
