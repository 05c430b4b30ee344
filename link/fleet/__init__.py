"""Fleets: vehicles and ground stations that meet at a Zenoh router, each under its own name."""
