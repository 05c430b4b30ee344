"""Widgets of the Parameters screen."""
