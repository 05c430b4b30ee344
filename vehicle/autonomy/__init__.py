"""Modes that drive without an operator: GUIDED, AUTO, RTL, SMART_RTL, LOITER."""
