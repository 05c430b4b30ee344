"""RecentEndpoints: the endpoints used before, newest first. Values only; recent_file.py reads and writes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import msgspec

from link.endpoint import EndpointError, parse_endpoint

LIMIT = 20
"""Endpoints that are remembered: as many as a screen of 80x24 lists."""

MAX_TEXT = 200
"""Characters of an endpoint or of a name: a longer one is nobody's."""

LATEST = 2.0**40
"""s since 1970: above any time of a real clock."""


class RecentError(ValueError):
    """The saved text is not what `encode` has written; the message is one line."""


class RecentEndpoint(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One endpoint that was opened."""

    endpoint: Annotated[str, msgspec.Meta(max_length=MAX_TEXT)]
    """As the user wrote it, e.g. "udpin:127.0.0.1:14550"."""
    used: Annotated[float, msgspec.Meta(ge=0.0, le=LATEST)]
    """Time of the last use, s since 1970. For the screen only: the order in RecentEndpoints counts."""
    vehicle: Annotated[str, msgspec.Meta(max_length=MAX_TEXT)] = ""
    """Name of the vehicle that was heard there last; "" if none was."""
    pinned: bool = False
    """Never pushed out by newer ones."""

    def __post_init__(self) -> None:
        """Check what the types do not. Raises ValueError."""
        if not (self.endpoint + self.vehicle).isprintable():
            raise ValueError("a text contains control characters")
        try:
            parse_endpoint(self.endpoint)
        except EndpointError as error:
            raise ValueError(str(error)) from error


class RecentEndpoints(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The endpoints used before. Each method returns the list that it leads to."""

    entries: tuple[RecentEndpoint, ...] = ()
    """Last used first, at most LIMIT, no endpoint twice."""

    @property
    def last(self) -> str | None:
        """The endpoint that was used last."""
        return self.entries[0].endpoint if self.entries else None

    @property
    def listed(self) -> tuple[RecentEndpoint, ...]:
        """The order to show them in: pinned ones first, in each part the last used first."""
        return tuple(sorted(self.entries, key=lambda each: not each.pinned))

    def find(self, endpoint: str) -> RecentEndpoint | None:
        """Return the entry of an endpoint."""
        return next((each for each in self.entries if each.endpoint == endpoint), None)

    def add(self, endpoint: str, now: float, vehicle: str = "") -> RecentEndpoints:
        """Note that an endpoint is used; without `vehicle` the name that is known stays. Raises ValueError.

        `now` is in s since 1970. Beyond LIMIT the one that was used longest ago is forgotten, a pinned one last.
        """
        before = self.find(endpoint)
        name = "".join(filter(str.isprintable, vehicle))[:MAX_TEXT] or (before.vehicle if before else "")
        entry = RecentEndpoint(endpoint, now, name, pinned=before is not None and before.pinned)
        return RecentEndpoints(_shorten((entry, *self._without(endpoint))))

    def add_all(self, endpoints: Sequence[str], now: float, vehicle: str = "") -> RecentEndpoints:
        """Note that endpoints are used together, so that the first one is `last`.

        The name is kept only if there is one: of several links it is not known which one brings the vehicle.
        """
        recent = self
        for endpoint in reversed(endpoints):
            recent = recent.add(endpoint, now, vehicle if len(endpoints) == 1 else "")
        return recent

    def pin(self, endpoint: str, pinned: bool = True) -> RecentEndpoints:
        """Pin an endpoint, or unpin it; an unknown one changes nothing."""
        changed = (
            msgspec.structs.replace(each, pinned=pinned) if each.endpoint == endpoint else each
            for each in self.entries
        )  # fmt: skip
        return RecentEndpoints(tuple(changed))

    def forget(self, endpoint: str) -> RecentEndpoints:
        """Remove an endpoint; an unknown one changes nothing."""
        return RecentEndpoints(self._without(endpoint))

    def _without(self, endpoint: str) -> tuple[RecentEndpoint, ...]:
        return tuple(each for each in self.entries if each.endpoint != endpoint)


def _shorten(entries: tuple[RecentEndpoint, ...]) -> tuple[RecentEndpoint, ...]:
    """Return at most LIMIT entries; the first one stays in any case."""
    while len(entries) > LIMIT:
        rest = entries[1:]
        last = next((each for each in reversed(rest) if not each.pinned), rest[-1])
        entries = tuple(each for each in entries if each is not last)
    return entries


def encode(recent: RecentEndpoints) -> bytes:
    """Return the entries as the text of a file (JSON)."""
    return msgspec.json.format(msgspec.json.encode(recent), indent=1) + b"\n"


def decode(data: bytes) -> RecentEndpoints:
    """Return the entries of a text. Raises RecentError."""
    try:
        found = msgspec.json.decode(data, type=RecentEndpoints)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise RecentError(" ".join(str(error).split())) from error
    if len(found.entries) > LIMIT or len({each.endpoint for each in found.entries}) < len(found.entries):
        raise RecentError("an endpoint is listed twice, or there are too many")
    return found
