"""Fleets: vehicles and ground stations that meet at a Zenoh router, each under its own name.

To add or change:
- which role a frame to a vehicle of a fleet needs: `link/fleet/roles.py`; how it is sent: `link/fleet/traffic.py`.
"""
