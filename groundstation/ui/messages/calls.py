"""MessageCalls: requests for the chosen message, its rate or one of it, and how the last one ended."""

from __future__ import annotations

from groundstation.intents.services import RequestMessage, ServiceIntent, SetMessageRate
from groundstation.ui.display.request_numbers import RequestNumbers, find_request
from groundstation.views.messages import MessageView
from groundstation.views.requests import RequestsRequest, RequestsView

NEVER = -1.0
"""Rate of a message that is not wanted."""


def parse_rate(text: str) -> float | None:
    """Return Hz; 0 for "0" and "default", NEVER for "off"; None for anything else."""
    word = text.strip().lower().removesuffix("hz").strip()
    if word in ("off", "default"):
        return NEVER if word == "off" else 0.0
    try:
        rate = float(word)
    except ValueError:
        return None
    return rate if 0 <= rate <= 1000 else None


class MessageCalls:
    """One request at a time is followed."""

    def __init__(self, numbers: RequestNumbers) -> None:
        self._numbers = numbers
        self._number: int | None = None

    @property
    def request(self) -> RequestsRequest | None:
        """Request for how it stands; None when nothing is under way."""
        return None if self._number is None else RequestsRequest()

    def set_rate(self, view: MessageView, rate: float) -> ServiceIntent:
        """Return the intent that requests a message at a rate."""
        self._number = self._numbers.take()
        return SetMessageRate(self._number, view.system, view.component, view.id, view.name, rate)

    def request_once(self, view: MessageView) -> ServiceIntent:
        """Return the intent that requests a message once."""
        self._number = self._numbers.take()
        return RequestMessage(self._number, view.system, view.component, view.id, view.name)

    def show(self, view: RequestsView) -> str | None:
        """Return how the request ended, once; None while it runs."""
        line = None if self._number is None else find_request(view, self._number)
        if line is None or line.state == "running":
            return None
        self._number = None
        return f"{line.what}: {line.state}" + (f", {line.detail}" if line.detail else "")
