"""One row for each message that the vehicle handles: who may send it, what it does, and its handler.

The rows of a service are in its `messages()`, and Dispatcher collects them. To handle another message, add a row there;
a message without a row is not even decoded. MAV_CMDs have rows of their own (command_table.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from typing import Any, Generic, TypeVar

import msgspec

from dialects.messages import Message
from link.core import Outgoing, Received
from vehicle.commands.access import Access

M = TypeVar("M", bound=Message)
Receive = Callable[[Received, float], Sequence[Outgoing]]


class Effect(Enum):
    """What the rover updates after the handler of a message."""

    DEMAND = "demand"
    """If the demand, the mode or the safety state has changed: motor outputs at once, and the telemetry of a demand."""
    MOTION = "motion"
    """Mode, motor outputs, and the telemetry that is due."""


class InboundMessage(msgspec.Struct, Generic[M], frozen=True):
    """One message that the vehicle handles."""

    message: type[M]
    access: Access
    """Checked before the handler, except for who is in control: each protocol denies that in its own way."""
    description: str
    handle: Callable[[Received, M, float], Sequence[Outgoing] | None]
    effect: Effect | None = None
    """None: nothing moves by it."""
    checks_sender: bool = False
    """The handler checks for a HEARTBEAT itself: it reports a denial, or lets anyone stop."""

    def accepts_unintroduced(self, received: Received) -> bool:
        """Return whether the message reaches its handler although its sender has sent no HEARTBEAT."""
        if self.checks_sender or self.access is Access.ANYONE:
            return True
        return self.access is Access.CONNECTED and received.may_ask


InboundTable = tuple[InboundMessage[Any], ...]


def from_server(receive: Receive) -> Callable[[Received, Message, float], Sequence[Outgoing]]:
    """Return a handler that passes the message to the `receive` of a protocol server."""
    return lambda received, message, now: receive(received, now)
