"""Arming, emergency stop, failsafes and health: decides whether the vehicle may move."""
