"""The bridge: joins any number of endpoints, for the Pi between an autopilot's serial port and the network."""
