"""What survives a restart: parameters, plans, logs."""
