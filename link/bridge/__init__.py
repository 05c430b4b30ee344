"""The bridge joins endpoints, e.g. on a Pi between an autopilot's serial port and the network."""
