"""Requests to the services of a vehicle: commands, parameters, plans, files, logs, messages.

To add or change:
- what an autopilot understands by start, pause, go to: `groundstation/vehicles/requests/mission_requests.py`.
"""
