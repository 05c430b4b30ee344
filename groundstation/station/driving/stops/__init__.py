"""Stops by the operator: the emergency stop, stops of vehicles that are not heard, quitting, and closing a link."""
