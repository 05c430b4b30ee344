"""Keys and gamepads: the gate that lets them drive, and what is pressed."""
