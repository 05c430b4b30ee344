"""Terminal ground station and its command line."""
