"""Widgets of the Replay screen."""
