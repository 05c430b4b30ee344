"""`mavhelm api`: a vehicle for a program of any language, by JSON lines; `groundstation.Rover` is its client in Python.

To add or change:
- a message of the protocol: `groundstation/rover/protocol.py`, its sender here and its reader in
  `groundstation/rover/async_rover.py`.
"""
