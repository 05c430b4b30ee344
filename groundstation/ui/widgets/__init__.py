"""Instruments: one module each, listed in groundstation/ui/instruments.py."""
