"""Panels of the Files screen."""
