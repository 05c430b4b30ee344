"""Records the session of a ground station into telemetry logs."""
