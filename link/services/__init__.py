"""MAVLink microservices (https://mavlink.io/en/services/), server and client halves, all sans-IO."""
