"""Discovery on the local network: MAVLink ends announce themselves by multicast DNS (RFC 6762) as _mavlink._udp.

To add or change:
- what a vehicle announces about itself on the network: `link/discovery/service.py`, `MavlinkService`.
"""
