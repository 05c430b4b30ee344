"""Data that survives a restart: parameters, plans and logs."""
