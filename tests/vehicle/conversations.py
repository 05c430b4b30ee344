"""Conversations of ground stations, for tests that have no link."""

from __future__ import annotations

from link.core import Peer
from vehicle.drive.conversation import Conversation

GCS = Peer(0, "gcs")


def conversation(system: int, component: int = 190, peer: Peer = GCS, numbering: int = 0) -> Conversation:
    """Return the conversation of a ground station; all are at one peer unless told."""
    return Conversation(system, component, peer, numbering)
