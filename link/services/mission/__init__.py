"""Mission protocol, for missions, fences and rally points."""
