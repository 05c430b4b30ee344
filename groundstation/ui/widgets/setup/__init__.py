"""Widgets of the Setup screen."""
