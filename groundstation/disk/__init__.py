"""Files on this machine that downloads write and uploads read."""
