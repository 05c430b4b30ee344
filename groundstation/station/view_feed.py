"""View feed: which views the screen watches, and which of them are due. Time is an argument."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

import msgspec

from groundstation.views.base import View, ViewRequest

_R = TypeVar("_R", bound=ViewRequest)


class ViewSource(msgspec.Struct, frozen=True):
    """Where the views of one kind of request come from."""

    build: Callable[[Any, float, float], View | None]
    """Called with the request, the time and the wall clock; None: nothing to show yet, or nothing new."""
    period: float = 0.2
    """Least time between two views, s. The first one after a screen opens is due at once."""


class _Watched(msgspec.Struct):
    """A request of the screen on top."""

    request: ViewRequest
    due: float = -math.inf
    sent: View | None = None


class ViewFeed:
    """Answers the newest requests of the screen, one of a kind at a time."""

    def __init__(self, sources: Mapping[type[ViewRequest], ViewSource]) -> None:
        self._sources = dict(sources)
        self._watched: dict[type[ViewRequest], _Watched] = {}
        self._others: list[ViewFeed] = []

    def open_another(self) -> ViewFeed:
        """Return a feed for one more screen, with the same sources."""
        other = ViewFeed({})
        other._sources = self._sources
        self._others.append(other)
        return other

    def close_another(self, other: ViewFeed) -> None:
        """End the feed of a screen that is gone."""
        self._others.remove(other)

    def add(self, kind: type[ViewRequest], source: ViewSource) -> None:
        """Add the source of one more kind of request."""
        self._sources[kind] = source

    def watch(self, requests: Sequence[ViewRequest]) -> None:
        """Answer these requests from now on and no others. A changed request keeps the rate of its kind.

        One without a source is ignored: its screen shows that nothing has arrived.
        """
        before, self._watched = self._watched, {}
        for request in (each for each in requests if type(each) in self._sources):
            watched = before.get(type(request)) or _Watched(request)
            if watched.request != request:
                watched.request, watched.sent = request, None
            self._watched[type(request)] = watched

    def is_watching(self, kind: type[ViewRequest]) -> bool:
        """Return whether a screen watches a view of this kind."""
        return kind in self._watched or any(other.is_watching(kind) for other in self._others)

    def requests(self, kind: type[_R]) -> Iterator[_R]:
        """Yield what all screens request of this kind."""
        if kind in self._watched:
            yield self._watched[kind].request  # type: ignore[misc]
        for other in self._others:
            yield from other.requests(kind)

    def build(self, request: ViewRequest, now: float, wall: float) -> View | None:
        """Build the view for a request at once, for a station without a screen."""
        return self._sources[type(request)].build(request, now, wall)

    def send_due(self, send: Callable[[View], bool], now: float, wall: float, *, paced_by: float | None = None) -> None:
        """Send the views that are due and have changed. `send` returns False for one that is to be tried again.

        `paced_by`: the clock of the periods, where `now` is a time that may stand still.
        """
        clock = now if paced_by is None else paced_by
        for kind, watched in self._watched.items():
            source = self._sources[kind]
            if clock < watched.due:
                continue
            view = source.build(watched.request, now, wall)
            if view is not None and view != watched.sent and send(view):
                watched.sent, watched.due = view, clock + source.period
