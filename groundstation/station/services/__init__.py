"""Requests of the operator to the services of a vehicle."""
