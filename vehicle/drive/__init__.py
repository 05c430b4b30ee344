"""The path from MANUAL_CONTROL to the motors: demand, mixer, slew rate, and the last gate."""
