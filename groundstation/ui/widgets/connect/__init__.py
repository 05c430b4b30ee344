"""Panels of the Connect screen."""
