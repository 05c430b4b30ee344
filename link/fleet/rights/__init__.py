"""What a frame to a vehicle may do, by more than its message: commands by meaning, stops by autopilot, transfers."""
