"""What the Map screen edits and shows, without widgets: plans, their fields, checks and geometry."""
