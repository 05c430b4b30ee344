"""Microservices of MAVLink, the server and the client half of each; all of them are cores."""
