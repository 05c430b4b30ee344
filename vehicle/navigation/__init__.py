"""Position estimate, path following, fence and rally points."""
