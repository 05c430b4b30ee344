"""Speed follows freshness: the rover never drives farther than FRESH_DIST after the newest command was sent.

While commands arrive in time this limits nothing. When they are late, get lost or end, the m driven since the newest
one was sent grow, and the speed falls so that the rover can still stop within the rest.
"""

from __future__ import annotations

import math
from collections import deque

from vehicle.drive.stopping import Stopping
from vehicle.params import Params

KEPT = 0.9
"""Share of FRESH_DIST that is planned with; the rest is for the steps of the cycles, and for wheels that are faster
than they report."""
RISE = 0.5
"""m/s2 at which a limit rises: between two commands it falls and rises, and the motors shall not follow that."""


class FreshnessLimit:
    """Call `update` whenever outputs are computed."""

    def __init__(self, params: Params) -> None:
        self.speed = math.inf
        """m/s that are allowed now; infinite while nothing is limited."""
        self._params = params
        self._generation = -1
        self._path: deque[tuple[float, float]] = deque()
        """Time and m driven until then, the newest last; from the last moment before the newest command was sent."""
        self._sent_at = -math.inf
        self._at = 0.0
        self._load_params()

    def update(self, sent_at: float | None, timeout: float, speed: float, now: float) -> float:
        """Return the m/s that are allowed; infinite without a limit.

        `sent_at`: the earliest time at which the newest command can have been sent, None without one. `timeout`: s from
        then on until it does not count any more at the latest. `speed`: m/s of the rover, whatever its direction.
        """
        if self._generation != self._params.generation:
            self._load_params()
        fastest = max(speed, self._top)
        if sent_at is None or not self._room or fastest * timeout + self._stopping.distance(fastest) <= self._room:
            self._path.clear()
            self._sent_at, self.speed = -math.inf, math.inf
            return math.inf
        self._sent_at = max(self._sent_at, sent_at)  # commands come in order, and an older echo proves less
        left = self._room - self._driven(fastest, speed, now)
        allowed = self._stopping.speed_within(left)
        risen = min(self.speed, fastest) + RISE * (now - self._at)
        self._at, self.speed = now, min(allowed, risen)
        return 0.0 if speed > allowed else self.speed

    def _driven(self, fastest: float, speed: float, now: float) -> float:
        """Return the m driven since the newest command was sent; what was not observed counts as `fastest`."""
        path = self._path
        before, driven = path[-1] if path else (now, 0.0)
        driven += speed * (now - before)
        path.append((now, driven))
        while len(path) > 1 and path[1][0] <= self._sent_at:
            path.popleft()
        oldest, at_oldest = path[0]
        return driven - at_oldest + fastest * max(0.0, oldest - self._sent_at)

    def _load_params(self) -> None:
        params, self._generation = self._params, self._params.generation
        self._stopping = Stopping.of(params)
        self._top: float = params["SPEED_MAX"]
        self._room: float = KEPT * params["FRESH_DIST"]
