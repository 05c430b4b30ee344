"""Link statistics for the screen: rates and losses computed from the counters of the links."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Sequence

import msgspec

from groundstation.snapshot import LinkView
from groundstation.station.links.path_figures import FiguresByLink, PathFigures
from groundstation.views.links import LinkRow, PathRow
from link.core import LinkReport, Peer, SigningCounts, SourceCount
from link.protocol.link_events import link_problem

LOSS_WINDOW = 5.0
"""s over which the loss is counted: at the 27 messages/s of ArduPilot's defaults one lost frame is 0.7 %."""

MAX_PEERS = 4
"""Peers of a link that a row names."""


class _Sample(msgspec.Struct, frozen=True):
    time: float
    report: LinkReport
    systems: tuple[int, ...]
    """The vehicle whose loss is counted, if there is one."""


class LinkStats:
    """The reports of the last seconds, by link."""

    def __init__(self) -> None:
        self._samples: dict[int, deque[_Sample]] = {}

    def update(self, reports: Sequence[LinkReport], system: int | None, now: float) -> None:
        """Add the reports of all links; `system` is the vehicle whose loss is counted."""
        reported = {report.index for report in reports}
        self._samples = {link: samples for link, samples in self._samples.items() if link in reported}
        for report in reports:
            samples = self._samples.setdefault(report.index, deque())
            samples.append(_Sample(now, report, () if system is None else (system,)))
            while now - samples[0].time > LOSS_WINDOW:
                samples.popleft()

    def remove(self, link: int) -> None:
        """Forget a link that was closed."""
        self._samples.pop(link, None)

    def systems(self, link: int) -> frozenset[int]:
        """Return the systems from which frames arrived on a link."""
        samples = self._samples.get(link)
        return frozenset(system for system, _ in samples[-1].report.sources) if samples else frozenset()

    @property
    def all_systems(self) -> frozenset[int]:
        """The systems from which frames arrived on any link."""
        return frozenset[int]().union(*map(self.systems, self._samples))

    def build_views(self, paths: FiguresByLink) -> tuple[LinkView, ...]:
        """Build the links' part of the snapshot; `paths` are those to the selected vehicle."""
        return tuple(_view(samples, paths.get(index, ())) for index, samples in sorted(self._samples.items()))

    def build_rows(self, paths: FiguresByLink, jitter: float | None, vehicles: Collection[int]) -> tuple[LinkRow, ...]:
        """Build the rows of the Links screen; `paths` and `jitter` are those of the selected vehicle.

        Losses are those of `vehicles`: of another ground station the vehicles forward only what is for us, too, so
        that its numbers have gaps without any loss.
        """
        return tuple(
            _row(samples, vehicles, paths.get(index, ()), jitter) for index, samples in sorted(self._samples.items())
        )

    @property
    def newest(self) -> tuple[LinkReport, ...]:
        """The newest report of each link."""
        return tuple(samples[-1].report for samples in self._samples.values())

    @property
    def signing(self) -> tuple[int, ...]:
        """System ids whose newest frame was signed, on any link."""
        return tuple(sorted({system for report in self.newest for system in report.signing}))

    def capacity(self, link: int) -> float | None:
        """Return how many bytes/s a link takes now; None if unknown."""
        samples = self._samples.get(link)
        report = samples[-1].report if samples else None
        return None if report is None or report.capacity is None else report.capacity * report.headroom

    def loss(self, link: int, system: int) -> float | None:
        """Return the lost fraction of the frames of a vehicle on a link; None if unknown."""
        samples = self._samples.get(link)
        return _loss(samples, (system,)) if samples else None

    @property
    def has_traffic(self) -> bool:
        """Any link received bytes within the window."""
        return any(_delta(samples, "bytes_received") > 0 for samples in self._samples.values())


def _delta(samples: deque[_Sample], name: str) -> float:
    first, last = samples[0].report, samples[-1].report
    return float(getattr(last, name) - getattr(first, name))


def _rate(samples: deque[_Sample], name: str) -> float:
    seconds = samples[-1].time - samples[0].time
    return max(0.0, _delta(samples, name) / seconds) if seconds else 0.0


def _loss(samples: deque[_Sample], systems: Collection[int]) -> float | None:
    """Return the lost fraction of the frames of these systems, which the first sample counts as well.

    Frames with unknown message ids (a tenth to a quarter of ArduPilot's) leave gaps in the numbers, but did arrive.
    """
    first, last = (_sum(sample.report, systems) for sample in (samples[0], samples[-1]))
    received, gaps = last.received - first.received, last.lost - first.lost
    lost = max(0, gaps - int(_delta(samples, "unknown")))
    return lost / (lost + received) if received > 0 and gaps >= 0 else None


def lost_frames(report: LinkReport, systems: Collection[int] | None = None) -> int:
    """Return how many frames of these systems (None: of all) were lost since the link opened; unknown ids were not."""
    wanted = {system for system, _ in report.sources} if systems is None else systems
    return max(0, _sum(report, wanted).lost - report.unknown)


def _sum(report: LinkReport, systems: Collection[int]) -> SourceCount:
    counts = [count for (source, _), count in report.sources.items() if source in systems]
    return SourceCount(sum(count.received for count in counts), sum(count.lost for count in counts))


def _row(
    samples: deque[_Sample], vehicles: Collection[int], paths: Sequence[PathFigures], jitter: float | None
) -> LinkRow:
    report = samples[-1].report
    best = paths[0] if paths else None
    return LinkRow(
        index=report.index,
        watch_only=report.watch_only,
        retry_in=report.retry_in,
        name=report.name,
        peers=tuple(_address(peer) for peer in report.audience if peer.address != report.name)[:MAX_PEERS],
        peer_count=report.peers,
        frames_in=round(_rate(samples, "frames"), 1),
        frames_out=round(_rate(samples, "frames_sent"), 1),
        bytes_in=round(_rate(samples, "bytes_received")),
        bytes_out=round(_rate(samples, "bytes_sent")),
        loss=_loss(samples, vehicles),
        lost=lost_frames(report, vehicles),
        crc_errors=report.crc_errors,
        refused=report.refused_peers,
        dropped=report.dropped,
        round_trip=best.round_trip if best else None,
        jitter=jitter if best and best.counts else None,
        age=round(best.age, 1) if best else None,
        counts=bool(best and best.counts),
        more=tuple(
            PathRow(address=_address(each.peer), round_trip=each.round_trip, age=round(each.age, 1))
            for each in paths[1 : MAX_PEERS + 1]
        ),
        capacity=report.capacity,
        headroom=report.headroom,
        unverified=_refused(report.refused),
        problem=link_problem(report),
    )


def _refused(counts: SigningCounts | None) -> str:
    """Return what signing has refused, in words."""
    if counts is None:
        return ""
    named = {"not signed": counts.unsigned, "wrong key": counts.bad, "replayed": counts.replayed,
             "clock behind": counts.too_old}  # fmt: skip
    return ", ".join(f"{number} {what}" for what, number in named.items() if number)


def _address(peer: Peer) -> str:
    """Return an address as text, for a socket's e.g. "192.168.4.20:50211" or "[::1]:50211"."""
    if not isinstance(peer.address, tuple):
        return str(peer.address)
    host, port = peer.address[:2]
    return f"[{host}]:{port}" if ":" in str(host) else f"{host}:{port}"


def _view(samples: deque[_Sample], paths: Sequence[PathFigures]) -> LinkView:
    newest, systems = samples[-1], samples[-1].systems
    best = paths[0] if paths else None
    return LinkView(
        name=newest.report.name,
        loss=_loss(samples, systems),
        round_trip=best.round_trip if best else None,
        age=round(best.age, 2) if best else None,
        counts=bool(best and best.counts),
        rate=_rate(samples, "frames"),
        bytes_per_second=_rate(samples, "bytes_received"),
        frames=newest.report.frames,
        bytes_received=newest.report.bytes_received,
        crc_errors=newest.report.crc_errors,
        dropped=newest.report.dropped,
        systems=tuple(sorted({system for system, _ in newest.report.sources})),
        problem=link_problem(newest.report),
        watch_only=newest.report.watch_only,
    )
