"""The simulated rovers, and the process that runs one.

To add or change:
- a simulated rover to choose: `groundstation/sitl/simulators.py`, `SIMULATORS`.
"""
