"""Discovery on the local network: MAVLink ends announce themselves by multicast DNS (RFC 6762) as _mavlink._udp."""
