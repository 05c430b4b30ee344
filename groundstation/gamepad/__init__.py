"""The gamepad: a process that reads it through SDL, and the screen's end of the pipe to it."""
