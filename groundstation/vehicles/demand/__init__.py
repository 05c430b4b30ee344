"""What moves or stops a vehicle: demands, neutral, commands that stop, and the last gate before the link."""
