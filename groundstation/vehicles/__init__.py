"""What the ground station knows of each vehicle, and what it asks of it."""
