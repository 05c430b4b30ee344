"""Instruments: one module each, listed in groundstation/ui/drive/instrument_table.py."""
