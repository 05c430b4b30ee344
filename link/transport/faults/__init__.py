"""Faults of a link on purpose: frames are lost, late or cut off between a transport and its channel.

The simulated rover has them (`mavhelm vehicle --sim --loss 20`), so that a bad network can be tried on one machine.

To add or change:
- a fault: its field in `settings.py`, its option in vehicle/cli/options.py, its effect in `faulty_transport.py`.
"""
