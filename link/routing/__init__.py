"""Forwards frames between links by system and component id."""
