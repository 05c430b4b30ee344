"""Microservices of MAVLink: client and server half of each in one file, all of them cores."""
