"""MAVLink signing: keys, their files, and (in other modules) signatures of frames."""
