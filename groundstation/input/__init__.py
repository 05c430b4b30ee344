"""Keyboard input: key maps, key repeat, drive styles, stick positions."""
