"""A simulated rover: chassis, battery and sensors, stepped with dt. No messages and no clock."""
