"""Driving: control of the vehicle, arming, demands, emergency stop, hand-over and shutdown."""
