"""Arming, emergency stop, failsafes and health: decides whether the vehicle may move.

To add or change:
- a reason not to arm: `vehicle/safety/arming.py`.
"""
