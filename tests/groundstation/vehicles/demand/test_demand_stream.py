"""When demands go out."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from dialects.axes import NEUTRAL, Axes
from groundstation.vehicles.demand.demand_stream import CLOSEST, DRIVING_PERIOD, FINAL_NEUTRALS, DemandStream

AHEAD = Axes(0.6, 0.0)


def play(stream: DemandStream, demand: Axes, streaming: bool, start: float, seconds: float) -> list[tuple[float, Axes]]:
    """Ask every 10 ms."""
    steps = [start + 0.01 * step for step in range(round(seconds * 100))]
    return [(now, sent) for now in steps if (sent := stream.next_due(demand, streaming, now)) is not None]


def test_nothing_is_sent_until_streaming() -> None:
    stream = DemandStream()
    assert play(stream, AHEAD, False, 0.0, 2.0) == []
    assert stream.finished


def test_change_goes_out_at_once() -> None:
    stream = DemandStream()
    assert stream.next_due(NEUTRAL, True, 10.0) == NEUTRAL
    assert stream.next_due(AHEAD, True, 10.011) == AHEAD
    assert stream.next_due(NEUTRAL, True, 10.012) == NEUTRAL, "neutral may follow at any distance"


def test_changes_too_close_for_vehicle_wait_and_the_newest_wins() -> None:
    stream = DemandStream()
    stream.next_due(AHEAD, True, 10.0)
    assert stream.next_due(Axes(0.6, 0.1), True, 10.001) is None
    assert stream.next_due(Axes(0.6, 0.2), True, 10.001 + CLOSEST) == Axes(0.6, 0.2)


def test_a_key_just_after_a_repeated_neutral_does_not_wait() -> None:
    stream = DemandStream()
    for step in range(5):
        stream.next_due(NEUTRAL, True, 10.0 + step * 0.2)
    assert stream.next_due(AHEAD, True, 10.801) == AHEAD


def test_steady_rates() -> None:
    stream = DemandStream()
    assert 19 <= len(play(stream, AHEAD, True, 0.0, 1.0)) <= 21
    after = play(stream, NEUTRAL, True, 1.0, 3.0)
    assert 19 <= len([at for at, _ in after if at < 2.0]) <= 22
    assert 9 <= len([at for at, _ in after if at >= 2.0]) <= 11


def test_a_coarse_tick_keeps_the_rate() -> None:
    stream = DemandStream()
    sent = [now for step in range(1000) if stream.next_due(AHEAD, True, now := step * 0.02)]
    assert 395 <= len(sent) <= 405


def test_a_pause_is_not_made_up_for() -> None:
    stream = DemandStream()
    stream.next_due(AHEAD, True, 0.0)
    assert len(play(stream, AHEAD, True, 5.0, 0.1)) <= 3


def test_five_neutrals_at_the_end_then_nothing() -> None:
    stream = DemandStream()
    play(stream, AHEAD, True, 0.0, 1.0)
    goodbye = play(stream, AHEAD, False, 1.0, 3.0)
    assert [demand for _, demand in goodbye] == [NEUTRAL] * FINAL_NEUTRALS
    assert goodbye[0][0] == 1.0
    assert goodbye[-1][0] <= 1.0 + FINAL_NEUTRALS * DRIVING_PERIOD
    assert stream.finished


@given(
    st.lists(
        st.tuples(st.floats(0.001, 0.2), st.sampled_from([NEUTRAL, AHEAD, Axes(0.0, 1.0)]), st.booleans()), max_size=60
    )
)
def test_what_may_not_stream_is_only_ever_neutral_and_few(steps: list[tuple[float, Axes, bool]]) -> None:
    stream, now = DemandStream(), 0.0
    farewells = 0
    for pause, demand, streaming in steps:
        now += pause
        sent = stream.next_due(demand, streaming, now)
        if streaming:
            farewells = 0
            assert sent is None or sent == demand
        elif sent is not None:
            farewells += 1
            assert sent == NEUTRAL
        assert farewells <= FINAL_NEUTRALS
