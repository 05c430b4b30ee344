"""Range sensors on the pins, I2C buses and serial ports of this computer, for vehicle/proximity.

To add a sensor: its settings with a tag in `vehicle/sensors/ranging/settings.py`, a class or parser in a module beside
it, and its row in `OPENERS` of `vehicle/sensors/ranging/sources.py`.
"""
