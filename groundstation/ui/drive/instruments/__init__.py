"""Instruments of the Drive screen."""
