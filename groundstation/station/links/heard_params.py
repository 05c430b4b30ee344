"""The names of parameters that vehicles report, whoever has requested them: a shell completes them."""

from __future__ import annotations

from dialects import messages as m
from link.core import Received
from link.services.param.values import name_from_wire

MAX_NAMES = 20_000
"""Of all vehicles; ArduPilot has 1200, PX4 1000."""


class HeardParams:
    """Collects the names in PARAM_VALUE."""

    def __init__(self) -> None:
        self.names: set[str] = set()

    def receive(self, received: Received) -> None:
        """Take a message; only PARAM_VALUE counts."""
        if isinstance(received.message, m.ParamValue) and len(self.names) < MAX_NAMES:
            self.names.add(name_from_wire(received.message._param_id_raw))
