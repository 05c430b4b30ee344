"""Health of a vehicle: sensors, estimates, and reasons why it does not arm."""
