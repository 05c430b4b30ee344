"""Who commands: the terminal ground station and its command line."""
