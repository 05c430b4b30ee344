"""State of each vehicle, and what the ground station requests from it."""
