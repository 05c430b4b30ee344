"""The Connect screen: vehicles that are heard, recent endpoints, serial ports, simulators."""
