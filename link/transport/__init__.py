"""Transports: UDP, TCP, serial ports and an in-memory pipe, with their transmit queues."""
