"""What the driver sees, a module an instrument."""
