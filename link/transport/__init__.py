"""UDP, TCP, serial and in-memory transports, and their send queues."""
