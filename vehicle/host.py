"""What the vehicle tells of the program and the computer that it is; the daemon knows it (vehicle/host_facts.py)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Host:
    """Unknown unless somebody says it."""

    uid: bytes = b""
    """16 bytes that are this computer's and no other's; empty: unknown."""
    load: float = 0.0
    """Share of the control loop's time that was used in the last second, 0..1."""
