"""What is measured of each path to the selected vehicle, as the screens and the doctor show it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import msgspec

from groundstation.vehicles.fleet import Contact
from groundstation.vehicles.paths.path import Path
from link.core import Peer

RoundTrip = Callable[[Peer], float | None]
"""Returns the round trip of a path, s; None if it is not known."""


class PathFigures(msgspec.Struct, frozen=True):
    """One path."""

    peer: Peer
    age: float
    """How old the newest news on it is, s."""
    round_trip: float | None
    counts: bool
    """It is the best one; of a vehicle that knows no proofs the one that carries the demands."""


FiguresByLink = Mapping[int, Sequence[PathFigures]]
"""Index of a link -> the paths to the selected vehicle on it, the best one first."""


def find_figures(contact: Contact | None, round_trip: RoundTrip, now: float) -> FiguresByLink:
    """Return what is known of the paths to a vehicle."""
    found: dict[int, list[PathFigures]] = {}
    if contact is None:
        return found
    counting = _find_counting(contact)
    for path in contact.state.paths.known:
        figures = PathFigures(path.peer, path.age(now), round_trip(path.peer), path is counting)
        found.setdefault(path.peer.link, []).append(figures)
    for each in found.values():
        each.sort(key=lambda path: not path.counts)
    return found


def _find_counting(contact: Contact) -> Path | None:
    paths = contact.state.paths
    carrier = None if contact.state.has_rover_dialect else paths.carrier.path
    return carrier if carrier is not None and paths.get(carrier.peer) is carrier else paths.best
