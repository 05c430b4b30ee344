"""Requests to the services of a vehicle: commands, parameters, plans, files, logs, messages."""
