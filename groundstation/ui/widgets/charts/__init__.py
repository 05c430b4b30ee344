"""Widgets of the Charts screen."""
