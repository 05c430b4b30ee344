"""State of a vehicle, as its messages report it."""
