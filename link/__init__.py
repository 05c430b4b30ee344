"""MAVLink for both programs: endpoints, transports, channels, routing, microservices, event loop."""
