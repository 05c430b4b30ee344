"""Session of a verb with a vehicle: link, endpoint, choice of vehicle, proof of control."""
