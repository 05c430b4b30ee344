"""SigningWatch: which state signing has between this station and a vehicle, from link reports and its texts."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence

from msgspec.structs import astuple

from groundstation.snapshot.signing import SigningState, SigningView
from link.core import LinkReport, SigningCounts

WINDOW = 5.0
"""s in which refused frames are counted."""
SHOWN_AHEAD = 1.0
"""s by which two clocks differ before it is shown; less is the way of the frames."""
KINDS = ("wrong key", "replayed", "not signed", "late")
"""Names of the fields of SigningCounts."""
REFUSED_UNSIGNED = "refused: not signed"
"""Part of the STATUSTEXT with which our vehicle refuses a request without a signature (vehicle/drive/roles.py)."""
INSTALL = "mavhelm sign install"
SIGNING = f"signs with a key that is not here, and may ignore us: {INSTALL}"
TEXTS = {
    SigningState.OFF: "off: the vehicle does not sign",
    SigningState.ON: "on: both ends sign",
    SigningState.NO_KEY: f"the vehicle {SIGNING}",
    SigningState.REQUIRED: f"required: the vehicle refuses what is not signed with a key that it has: {INSTALL}",
    SigningState.REPLAYED: "replayed: only frames arrive that were here before; nothing new of the vehicle",
}


class SigningWatch:
    """Keeps what links report of each system, and which vehicle requires signing. `system` is ours."""

    def __init__(self, system: int) -> None:
        self._refused_us = f"GCS {system}: "
        self._samples: dict[int, deque[tuple[float, tuple[int, ...]]]] = {}
        """System -> refused frames in the order of KINDS, newest last, of the last WINDOW."""
        self._requires: set[int] = set()
        self._behind: dict[int, float] = {}
        self._ahead: dict[int, float] = {}
        self._key = ""

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Store the reports of all links."""
        guards = [report.guard for report in reports if report.guard is not None]
        self._key = next((guard.key for guard in guards), "")
        self._behind = {system: s for guard in guards for system, s in guard.behind.items()}
        self._ahead = {system: s for guard in guards for system, s in guard.ahead.items()}
        for system in {system for guard in guards for system in guard.refused}:
            total = _sum(guard.refused.get(system, SigningCounts()) for guard in guards)
            samples = self._samples.setdefault(system, deque([(now, (0,) * len(KINDS))]))
            samples.append((now, total))
            while len(samples) > 2 and now - samples[1][0] > WINDOW:
                samples.popleft()

    def handle_text(self, system: int, text: str) -> None:
        """Notice that a vehicle refuses what we do not sign."""
        if text.startswith(self._refused_us) and REFUSED_UNSIGNED in text:
            self._requires.add(system)

    def build_view(self, system: int, now: float, *, alive: bool, verified: bool, signs: bool) -> SigningView:
        """Return what is known of a vehicle. `signs`: with a key that is not here."""
        if verified:
            self._requires.discard(system)
        counts = self._recent(system, now)
        state = _judge(counts, alive=alive, verified=verified, signs=signs, required=system in self._requires)
        return SigningView(state, self._describe(state, system, counts), _name(counts), self._clock(system))

    def find_refused(self, now: float) -> SigningView | None:
        """Return what is known while there is no vehicle: the system of which most was refused; None without any."""
        recent = {system: self._recent(system, now) for system in self._samples}
        system = max(recent, key=lambda each: sum(recent[each]), default=None)
        if system is None or not any(recent[system]):
            return None
        return self.build_view(system, now, alive=False, verified=False, signs=False)

    def _recent(self, system: int, now: float) -> tuple[int, ...]:
        samples = self._samples.get(system)
        if samples is None or now - samples[-1][0] > WINDOW:
            return (0,) * len(KINDS)
        return tuple(max(0, last - first) for first, last in zip(samples[0][1], samples[-1][1], strict=True))

    def _describe(self, state: SigningState, system: int, counts: tuple[int, ...]) -> str:
        if state is SigningState.REJECTED:
            signs = "it must sign, as it did before or as is required here"
            helps = "compare the fingerprints of both ends" if counts[0] else signs
            return f"rejected: {_name(counts)} from system {system}; {helps}"
        if state is SigningState.CLOCK:
            return f"clock: that of system {system} is {_duration(self._behind.get(system))} behind ours: set it"
        if state in (SigningState.ON, SigningState.OFF) and self._key:
            return f"{TEXTS[state]}; our key is {self._key}"
        return TEXTS[state]

    def _clock(self, system: int) -> str:
        ahead = self._ahead.get(system, 0.0)
        return f"its clock is {_duration(ahead)} ahead of ours; we sign with its time" if ahead >= SHOWN_AHEAD else ""


def _judge(counts: tuple[int, ...], *, alive: bool, verified: bool, signs: bool, required: bool) -> SigningState:
    """Return the state: what passes decides before what is refused, which anybody may have sent."""
    if alive and verified:
        return SigningState.ON
    wrong, _, unsigned, late = counts
    if not alive and any(counts):
        if late:
            return SigningState.CLOCK
        return SigningState.REJECTED if wrong or unsigned else SigningState.REPLAYED
    if required:
        return SigningState.REQUIRED
    return SigningState.NO_KEY if signs else SigningState.ON if verified else SigningState.OFF


def _sum(counts: Iterable[SigningCounts]) -> tuple[int, ...]:
    return tuple(map(sum, zip(*map(astuple, counts), strict=True)))


def _name(counts: tuple[int, ...]) -> str:
    return ", ".join(f"{number} {what}" for number, what in zip(counts, KINDS, strict=True) if number)


def _duration(seconds: float | None) -> str:
    if seconds is None:
        return "more than a minute"
    for size, unit in ((86_400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds:.0f} s"
