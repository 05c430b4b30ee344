"""Calibration of a vehicle's sensors."""
