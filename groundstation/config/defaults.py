"""What names endpoints where nothing else does. Verbs import it without the settings, which take long."""

from __future__ import annotations

DEFAULT_ENDPOINT = "udpin:127.0.0.1:14550"
"""The port that vehicles and simulators usually send to; this machine only, because MAVLink has no password."""
ENDPOINT_VARIABLE = "MAVHELM_ENDPOINT"
"""Endpoints or their names, separated by spaces."""
