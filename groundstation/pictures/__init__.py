"""Pictures in a terminal, without input, output and clock: encoders, choice of one, age, bytes a second.

To add or change:
- a way to draw: its `Protocol` in `groundstation/pictures/protocol.py`, its class and its row in
  `groundstation/pictures/painters.py`, `PAINTERS`.
"""
