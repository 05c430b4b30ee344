"""How it travels: endpoints, framing, channels, services, the one loop. Knows both ends, belongs to neither."""
