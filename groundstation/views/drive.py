"""Views of the Drive screen: what its panes and charts show, at their own rates and only while they are shown."""

from __future__ import annotations

from groundstation.views.base import View, ViewRequest


class TrackRequest(ViewRequest, frozen=True):
    """The track of the selected vehicle."""


class TrackView(View, frozen=True):
    """Earlier positions of a vehicle, oldest first, thinned to at most 500: north, east of its origin, m."""

    system: int
    points: tuple[tuple[float, float], ...]


class SpeedRequest(ViewRequest, frozen=True):
    """Speed of the selected vehicle in the last minute."""


class SpeedView(View, frozen=True):
    """Speed, and the speed that was demanded, oldest first."""

    system: int
    points: tuple[tuple[float, float | None, float | None], ...]
    """Time in s on the station's clock, speed, demanded speed; None: not known then."""
