"""How many peers one link of a station has at most."""

from __future__ import annotations

from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES
from link.protocol.peer_table import MAX_PEERS

PLACES = MAX_VEHICLES + MAX_PEERS
"""Each vehicle may have an address of its own, and ground stations come beside them."""
