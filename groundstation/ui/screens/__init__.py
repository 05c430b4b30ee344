"""Screens: one module and one .tcss file each, listed in groundstation/screens.py."""
