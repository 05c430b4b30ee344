"""What stops a vehicle, and when: its settings and what they mean."""
