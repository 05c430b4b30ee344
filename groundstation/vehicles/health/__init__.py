"""Health of a vehicle: sensors, estimates, and reasons why it does not arm.

To add or change:
- a line of the vehicle's health: `groundstation/vehicles/health/health.py`, `READERS`.
"""
