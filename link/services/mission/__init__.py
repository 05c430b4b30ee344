"""The mission protocol, for missions, fences and rally points."""
