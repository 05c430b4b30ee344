"""Numbers of the requests to the station: each is used once, whichever screen makes it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count

from groundstation.views.requests import RequestLine, RequestsView


class RequestNumbers:
    """Counts from `first`, which the station gives each screen, so that no two use the same number."""

    def __init__(self, first: int = 1) -> None:
        self.take: Callable[[], int] = count(first).__next__
        """Returns the next number."""


def find_request(view: RequestsView, number: int) -> RequestLine | None:
    """Return how the request with this number stands; None if the view does not know it (any more)."""
    return next((line for line in (*view.running, *view.ended) if line.number == number), None)
