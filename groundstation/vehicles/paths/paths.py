"""The paths to one vehicle as one conversation: what counts of what they bring, and which is the best.

State with a time of the vehicle (time_boot_ms) counts if it is newer than what any path has brought. State without
one counts from the best path, and from another one only where that brings none. Answers always count: they come over
the path of their question. Events count once (copies.py).

Two vehicles with one id are no paths to one vehicle: then everything counts (groundstation/vehicles/state/senders.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dialects import messages as m
from dialects.traits import ACKED
from groundstation.vehicles.paths.carrier import Carrier
from groundstation.vehicles.paths.copies import TOLD, EventCopies
from groundstation.vehicles.paths.path import LATE, REBOOT_STEP, Path, is_older
from groundstation.vehicles.paths.questions import ANSWERS, Questions
from link.core import Peer, Received

SILENCE = 0.3
"""s of silence after which another path takes the place of one that counts, if it is heard."""
MESSAGES = 3
"""Messages that the other path must have brought meanwhile: at rest a vehicle sends a few per second, in turn."""
LONG_SILENCE = 1.2
"""s of silence after which one message is enough: longer than from one heartbeat to the next."""
BETTER = 0.5
"""Part of the cost of the best path that another one must fall below to become the best."""
STAY = 2.0
"""s for which a path stays the best unless it falls silent."""
SERVED, SERVED_LATE = 3.0, 10.0
"""s for which a message of the best path is missed there before another path brings it; the second: a late one."""
FORGOTTEN = 10.0
"""s of silence after which a path is forgotten."""
MAX_PATHS = 16
"""Addresses of one vehicle; a flood of invented ones must not grow a table."""
BEHIND = 300
"""ms by which the clock of a path is behind the newest from which on its state without a time is old."""
DRIFT = 1e-4
"""s by which two clocks may differ after a second: the fastest path is not the fastest for ever."""

MessageKey = tuple[int, type[m.Message]]


class Paths:
    """The paths to one system. `component`: whose clock is looked at."""

    def __init__(self, component: int) -> None:
        self.component = component
        self.best: Path | None = None
        """The one that counts; None before the first message."""
        self.boot_time: int | None = None
        """Newest time_boot_ms over all paths, ms."""
        self.apart = False
        """They lead to two vehicles."""
        self.on_new: Callable[[float], None] = lambda now: None
        """Called when a further path is found."""
        self.questions, self.carrier = Questions(), Carrier()
        self._paths: dict[Peer, Path] = {}
        self._newest: dict[MessageKey, tuple[Path, int | None, float]] = {}
        """Of each state message: who brought it last, its time_boot_ms, and when."""
        self._copies = EventCopies()
        self._fastest = math.inf
        """The smallest offset of any path."""
        self._fastest_at = 0.0
        self._chosen_at = -math.inf

    @property
    def has_several(self) -> bool:
        """Whether the vehicle was heard on more than one path lately."""
        return len(self._paths) > 1

    def get(self, peer: Peer) -> Path | None:
        """Return the path to a peer; None if it is not one of this vehicle."""
        return self._paths.get(peer)

    def is_late(self, peer: Peer) -> bool:
        """Return whether a path that is not the best one brings old news."""
        path = self._paths.get(peer)
        return path is not None and path is not self.best and path.lag > LATE

    def live(self, now: float) -> list[Path]:
        """Return the paths that are heard, the best one first."""
        found = [each for each in self._paths.values() if each.is_live(now)]
        return sorted(found, key=lambda each: (each is not self.best, each.cost))

    @property
    def known(self) -> list[Path]:
        """All paths, the best one first: also those that are silent, until they are forgotten."""
        return sorted(self._paths.values(), key=lambda each: (each is not self.best, each.cost))

    def receive(self, received: Received, now: float) -> bool:
        """Note a message of the system; return whether it counts."""
        path = self._paths.get(received.peer) or self._add(received.peer, now)
        path.heard_at = now
        message = received.message
        if type(message).id in ANSWERS:
            self.questions.note_answer(message)
        stamp: int | None = None
        if received.component == self.component:
            stamp = getattr(message, "time_boot_ms", None)
            if stamp is not None:
                self._note_stamp(path, stamp, now)
        if len(self._paths) == 1:
            return True
        self._choose_if_silent(path, now)
        return self.apart or self._counts(path, received, stamp, now)

    def observe(self, loss: Callable[[int], float | None], trip: Callable[[Peer], float | None], now: float) -> None:
        """Update what was measured of each link and peer, and change to a path that is much better."""
        for peer, path in list(self._paths.items()):
            if now - path.heard_at > FORGOTTEN and len(self._paths) > 1 and path is not self.best:
                del self._paths[peer]
                self._newest = {kind: each for kind, each in self._newest.items() if each[0] is not path}
                continue
            path.loss, path.round_trip = loss(peer.link) or 0.0, trip(peer)
        best = self.best
        if best is None or now - self._chosen_at < STAY:
            return
        better = min(self.live(now), key=lambda each: each.cost, default=best)
        if better.cost < BETTER * best.cost:
            self._choose(better, now)

    # ---- what counts ----

    def _counts(self, path: Path, received: Received, stamp: int | None, now: float) -> bool:
        message = received.message
        kind = type(message)
        if kind in TOLD:
            return self._copies.is_first(message, received.component, path.peer, now)
        if kind.id in ACKED:
            return True
        if path.old_boot:
            return False
        last = self._newest.get((received.component, kind))
        if last is None or last[0] is path:
            counts = stamp is not None or not self._is_behind(path)
        elif stamp is not None and last[1] is not None:
            counts = stamp != last[1] and not is_older(stamp, last[1])
        else:
            counts = not self._is_behind(path) and (path is self.best or self._is_missed(last, path, now))
        if counts:
            self._newest[received.component, kind] = (path, stamp, now)
        return counts

    def _is_behind(self, path: Path) -> bool:
        """Return whether what a path brings is older than what another one has brought."""
        if path.stamp is None or self.boot_time is None:
            return False
        return is_older(path.stamp, self.boot_time) > BEHIND

    @staticmethod
    def _is_missed(last: tuple[Path, int | None, float], path: Path, now: float) -> bool:
        return now - last[2] > (SERVED_LATE if path.lag > LATE else SERVED)

    # ---- clocks ----

    def _note_stamp(self, path: Path, stamp: int, now: float) -> None:
        known = path.old_boot  # another path has shown the reboot
        if path.note_stamp(stamp, now) and not known:
            self._begin_boot(path)
        if path.old_boot:
            return
        self._fastest = min(path.offset, self._fastest + DRIFT * (now - self._fastest_at))
        self._fastest_at = now
        path.lag = max(0.0, path.offset - self._fastest)
        if self.boot_time is None or not is_older(stamp, self.boot_time) or len(self._paths) == 1:
            self.boot_time = stamp

    def _begin_boot(self, path: Path) -> None:
        """Handle a reboot that a path shows. Those that show none yet bring what is older."""
        for each in self._paths.values():
            each.old_boot = each is not path and each.stamp is not None and not self._has_rebooted(each, path)
        self._newest.clear()
        self._fastest, self.boot_time = path.offset, path.stamp

    @staticmethod
    def _has_rebooted(path: Path, first: Path) -> bool:
        """Return whether the clock of a path is already that of the boot that another one shows."""
        assert path.stamp is not None
        assert first.stamp is not None
        return abs(path.stamp - first.stamp) <= REBOOT_STEP

    # ---- which is the best ----

    def _add(self, peer: Peer, now: float) -> Path:
        if len(self._paths) >= MAX_PATHS:
            others = [each for each in self._paths.values() if each is not self.best]
            del self._paths[min(others, key=lambda each: each.heard_at).peer]
        path = self._paths[peer] = Path(peer)
        if self.best is None:
            self._choose(path, now)
        else:
            self.on_new(now)
        return path

    def _choose_if_silent(self, path: Path, now: float) -> None:
        best = self.best
        assert best is not None
        if path is best:
            for each in self._paths.values():
                each.heard = 0
            return
        path.heard += 1
        silence = now - best.heard_at
        if silence > (SILENCE if path.heard >= MESSAGES else LONG_SILENCE):
            self._choose(path, now)

    def _choose(self, path: Path, now: float) -> None:
        self.best, self._chosen_at, path.heard = path, now, 0
        known = path.stamp is not None and self.boot_time is not None
        if known and is_older(path.stamp or 0, self.boot_time or 0) > REBOOT_STEP:
            self._begin_boot(path)  # it has come back from another address after a reboot
