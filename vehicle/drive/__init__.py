"""From MANUAL_CONTROL to motor outputs: demand, mixer, slew rate, and the last gate before the motors."""
