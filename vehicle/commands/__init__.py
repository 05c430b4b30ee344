"""What the vehicle does with each message and MAV_CMD that it receives.

To add or change:
- what the key of a sender must allow: `role` of the command's row; where no row says it: `NEEDED_ROLES` in
  `vehicle/commands/access.py`.
- what a joystick button may do: `vehicle/commands/buttons.py`, `FUNCTIONS`.
- a command for accessories: `vehicle/commands/accessories.py`.
"""
