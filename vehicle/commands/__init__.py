"""What the vehicle does with each message and MAV_CMD that it receives."""
