"""Rates and losses out of the links' counters."""

from __future__ import annotations

from typing import Any

import pytest

from groundstation.station.links.link_stats import LinkStats, lost_frames
from groundstation.station.links.path_figures import PathFigures
from groundstation.views.links import PathRow
from link.core import LinkReport, Peer, SourceCount

PATHS = {0: (PathFigures(Peer(0, "far"), 0.1, 0.02, True),)}


def report(received: int, lost: int = 0, **changes: Any) -> LinkReport:
    counts = {(1, 1): SourceCount(received, lost), (7, 1): SourceCount(1000 * received, 0)}
    return LinkReport("udpin:127.0.0.1:14550", frames=received, bytes_received=20 * received, sources=counts, **changes)


def test_loss_and_rates_over_the_window_of_one_vehicle() -> None:
    stats = LinkStats()
    for second in range(20):
        stats.update([report(30 * second, 10 * second)], 1, float(second))
    (view,) = stats.build_views(PATHS)
    assert view.loss == pytest.approx(0.25)
    assert view.rate == pytest.approx(30.0)
    assert view.bytes_per_second == pytest.approx(600.0)
    assert view.round_trip == 0.02


def test_old_loss_is_forgotten() -> None:
    stats = LinkStats()
    for second in range(20):
        stats.update([report(30 * second, min(10 * second, 50))], 1, float(second))
    assert stats.build_views({})[0].loss == 0.0


def test_frames_of_unknown_ids_are_not_lost() -> None:
    stats = LinkStats()
    for second in range(20):
        stats.update([report(30 * second, 10 * second, unknown=9 * second)], 1, float(second))
    assert stats.build_views({})[0].loss == pytest.approx(1 / 31)


def test_unknown_frames_before_a_choice_are_not_lost() -> None:
    stats = LinkStats()
    for second, system in ((0, None), (1, 1), (2, 1)):  # a verb that comes to a station after 1000 s
        stats.update(
            [report(30_000 + 30 * second, 3000 + 3 * second, unknown=3000 + 3 * second)], system, float(second)
        )
    assert stats.build_views({})[0].loss == 0.0


def test_lost_frames_leave_out_unknown_ids() -> None:
    assert lost_frames(report(100, 32, unknown=30)) == 2
    assert lost_frames(report(100, 3, unknown=30)) == 0
    assert lost_frames(report(100, 32, unknown=30), (7,)) == 0


def test_noise_that_looks_like_frames_makes_no_negative_loss() -> None:
    stats = LinkStats()
    for second in range(20):
        stats.update([report(30 * second, second, unknown=9 * second)], 1, float(second))
    assert stats.build_views({})[0].loss == 0.0


def test_nothing_is_known_of_a_silent_link() -> None:
    stats = LinkStats()
    stats.update([report(0)], None, 0.0)
    (view,) = stats.build_views({})
    assert (view.loss, view.round_trip, view.rate) == (None, None, 0.0)
    assert not stats.has_traffic


def test_counters_that_start_again_make_no_nonsense() -> None:
    stats = LinkStats()
    stats.update([report(1000, 500)], 1, 0.0)
    stats.update([report(10, 0)], 1, 1.0)
    (view,) = stats.build_views({})
    assert view.loss is None
    assert view.rate == 0.0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"down": "cable out"}, "cable out"),
        ({"own_id": True}, "another program sends with our system"),
        (
            {"dialect_mismatch": ("HEARTBEAT", "ATTITUDE")},
            "another dialect's checksum and are dropped: HEARTBEAT, ATTITUDE",
        ),
    ],
)
def test_problems_are_described(changes: dict[str, Any], words: str) -> None:
    stats = LinkStats()
    stats.update([report(1, **changes)], 1, 0.0)
    problem = stats.build_views({})[0].problem
    assert problem is not None
    assert words in problem


def test_a_radio_that_is_full_makes_less_of_the_capacity() -> None:
    stats = LinkStats()
    stats.update([LinkReport("serial:/dev/ttyUSB0:57600", 0, capacity=5760.0, headroom=0.5)], None, 100.0)
    assert (stats.capacity(0), stats.capacity(1)) == (2880.0, None)


def test_a_row_has_the_losses_of_vehicles_and_both_directions() -> None:
    stats = LinkStats()
    for second in range(20):
        sent = {"frames_sent": 10 * second, "bytes_sent": 400 * second}
        stats.update([report(30 * second, 10 * second, capacity=5760.0, **sent)], 1, float(second))
    (row,) = stats.build_rows(PATHS, 0.001, (1, 2))
    assert (row.frames_in, row.frames_out, row.bytes_in, row.bytes_out) == (30.0, 10.0, 600.0, 400.0)
    assert row.loss == pytest.approx(0.25)
    assert row.lost == 190
    assert (row.round_trip, row.jitter) == (0.02, 0.001)
    assert row.share == pytest.approx(600 / 5760)


def test_each_link_has_the_round_trip_and_age_of_its_path() -> None:
    stats = LinkStats()
    stats.update([report(1), report(1, index=1), report(1, index=2)], 1, 0.0)
    late = (PathFigures(Peer(1, "far"), 1.96, 0.8, False), PathFigures(Peer(1, ("10.0.0.9", 5)), 2.5, None, False))
    rows = stats.build_rows(PATHS | {1: late}, 0.001, (1,))
    assert [(row.round_trip, row.age, row.counts, row.jitter) for row in rows] == [
        (0.02, 0.1, True, 0.001), (0.8, 2.0, False, None), (None, None, False, None),
    ]  # fmt: skip
    assert rows[1].more == (PathRow(address="10.0.0.9:5", age=2.5),)
    views = stats.build_views(PATHS | {1: late})
    assert [(view.round_trip, view.age, view.counts) for view in views] == [
        (0.02, 0.1, True), (0.8, 1.96, False), (None, None, False),
    ]  # fmt: skip


def test_a_row_names_the_first_peers_and_not_the_endpoint_itself() -> None:
    stats = LinkStats()
    name = "udpin:127.0.0.1:14550"
    peers = [Peer(0, name), Peer(0, ("::1", 5, 0, 0)), *(Peer(0, ("10.0.0.1", 5000 + number)) for number in range(9))]
    stats.update([report(1, audience=tuple(peers), peers=9, refused_peers=2, dropped=3, crc_errors=4)], 1, 0.0)
    (row,) = stats.build_rows({}, None, ())
    assert row.peers == ("[::1]:5", "10.0.0.1:5000", "10.0.0.1:5001", "10.0.0.1:5002")
    assert (row.peer_count, row.refused, row.dropped, row.crc_errors) == (9, 2, 3, 4)


def test_systems_that_sign_on_any_link() -> None:
    stats = LinkStats()
    stats.update([report(1, signing=frozenset({7, 1})), report(1, index=1, signing=frozenset({3}))], 1, 0.0)
    assert stats.signing == (1, 3, 7)


def test_gaps_of_a_forwarded_ground_station_are_no_loss() -> None:
    stats = LinkStats()
    for second in range(20):
        sources = {(1, 1): SourceCount(30 * second, 0), (250, 190): SourceCount(second, 20 * second)}
        stats.update([LinkReport("udpin:127.0.0.1:14550", sources=sources)], 1, float(second))
    (row,) = stats.build_rows({}, None, (1,))
    assert (row.loss, row.lost) == (0.0, 0)
