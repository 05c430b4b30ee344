"""Who goes first on a slow wire, what is given up, and how far ahead of it we write."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from dialects.messages import (
    Attitude,
    CommandLong,
    ManualControl,
    SetAttitudeTarget,
    SetPositionTargetGlobalInt,
    SetPositionTargetLocalNed,
)
from link.protocol.framer import Framer
from link.transport.priority_queue import MAX_DRIVER_BACKLOG, MAX_URGENT, STALE, TransmitPacer, TransmitQueue
from tests.link.frames import demand, frame, heartbeat

DISARM = frame(CommandLong(1, 1, 400, 0, 0, 0, 0, 0, 0, 0, 0), 9)
ARM = frame(CommandLong(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0), 9)


def attitude(number: int) -> bytes:
    return frame(Attitude(number, 0.5, 0, 0, 0, 0, 1), number % 256, 1, 1)


def drained(queue: TransmitQueue, now: float = 0.0) -> list[bytes]:
    frames = []
    while data := queue.pop(now):
        frames.append(data)
    return frames


def test_control_overtakes_telemetry_and_both_keep_their_order() -> None:
    queue = TransmitQueue(1000)
    order = [attitude(1), attitude(2), ARM, attitude(3), heartbeat(4)]
    for data in order:
        queue.push(data, 0.0)
    assert drained(queue) == [order[2], order[4], order[0], order[1], order[3]]


def test_the_oldest_telemetry_goes_when_it_is_full() -> None:
    queue = TransmitQueue(10 * len(attitude(1)))
    for number in range(30):
        queue.push(attitude(number), 0.0)
    assert drained(queue) == [attitude(number) for number in range(20, 30)]
    assert queue.dropped == 20


def test_only_the_newest_demand_of_a_target_waits_in_its_place() -> None:
    queue = TransmitQueue(1000)
    for data in (demand(1), ARM, demand(2, target=2), demand(3, throttle=0.0)):
        queue.push(data, 0.0)
    assert drained(queue) == [demand(3, throttle=0.0), ARM, demand(2, target=2)]


def test_setpoints_are_demands_too() -> None:
    def setpoint(number: int, speed: float) -> bytes:
        return frame(SetPositionTargetLocalNed(0, 1, 1, 8, 1479, 0, 0, 0, speed, 0, 0, 0, 0, 0, 0, 0), number)

    attitude_target = frame(SetAttitudeTarget(0, 1, 1, 0, [1, 0, 0, 0], 0, 0, 0, 0.5), 3)
    elsewhere = frame(SetPositionTargetGlobalInt(0, 1, 1, 6, 1479, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0), 4)
    queue = TransmitQueue(1000)
    for data in (attitude(1), setpoint(1, 0.5), attitude_target, setpoint(2, 0.0), elsewhere):
        queue.push(data, 0.0)
    assert drained(queue) == [setpoint(2, 0.0), attitude_target, elsewhere, attitude(1)]


def test_what_waited_too_long_is_not_sent_but_a_stop_is() -> None:
    queue = TransmitQueue(1000)
    for data in (demand(1), ARM, DISARM, attitude(1)):
        queue.push(data, 0.0)
    queue.push(heartbeat(7), STALE)
    assert drained(queue, STALE + 0.01) == [DISARM, heartbeat(7)]
    assert queue.dropped == 3


def test_a_flood_of_commands_pushes_no_stop_out() -> None:
    queue = TransmitQueue(1000)
    queue.push(DISARM, 0.0)
    for _ in range(10 * MAX_URGENT):
        queue.push(ARM, 0.0)
    frames = drained(queue)
    assert DISARM in frames
    assert len(frames) == MAX_URGENT


@given(
    st.lists(
        st.tuples(
            st.sampled_from([demand(1), heartbeat(2), ARM, DISARM, attitude(3), b"\xfd", b"x"]), st.floats(0, 0.3)
        )
    )
)
def test_what_goes_in_comes_out_or_is_counted_and_stops_come_out(puts: list[tuple[bytes, float]]) -> None:
    queue = TransmitQueue(200)
    now = 0.0
    for data, later in puts:
        now += later
        queue.push(data, now)
    frames = drained(queue, now)
    assert len(frames) + queue.dropped == len(puts)
    stops = sum(data == DISARM for data, _ in puts)
    assert frames.count(DISARM) == stops or stops > MAX_URGENT


# ---- the pace ----


def test_the_driver_never_holds_more_than_20_ms() -> None:
    pacer, now, written = TransmitPacer(5760.0), 10.0, 0
    while now < 11.0:
        wait = pacer.delay(40, 0, now)
        if wait == 0.0:
            pacer.record_written(40, now)
            written += 40
            assert written <= (now - 10.0 + MAX_DRIVER_BACKLOG) * 5760 + 1
        now += max(wait, 0.0001)
    assert written > 5700  # and the wire never runs dry


def test_a_long_frame_goes_when_the_wire_is_nearly_free() -> None:
    pacer = TransmitPacer(5760.0)
    assert pacer.delay(280, 0, 1.0) == 0.0
    pacer.record_written(280, 1.0)
    assert 0.04 < pacer.delay(280, 0, 1.0) < 280 / 5760


def test_the_driver_is_believed_when_it_says_that_it_is_behind() -> None:
    assert TransmitPacer(5760.0).delay(40, 0, 1.0) == 0.0
    assert TransmitPacer(5760.0).delay(40, 1024, 1.0) > 0.1


def test_a_demand_has_less_than_30_ms_of_bytes_ahead_of_it() -> None:
    # 57600 baud, a parameter list and telemetry for ever. Counted in bytes on the wire, not in time of this machine.
    capacity = 5760.0
    pacer, queue, now = TransmitPacer(capacity), TransmitQueue(1440), 0.0
    wire: list[bytes] = []
    sent_bytes = 0
    for step in range(5000):
        now = step * 0.001
        queue.push(attitude(step), now)
        if step % 50 == 25:
            queue.push(demand(step % 256), now)
        while (size := queue.next_size(now)) and pacer.delay(size, 0, now) == 0.0:
            data = queue.pop(now)
            pacer.record_written(len(data), now)
            wire.append(data)
            sent_bytes += len(data)
            message_id, _, _, sequence, _ = Framer(stream=False).feed(data, now)[0]
            if message_id == ManualControl.id:
                ahead = sent_bytes - len(data) - int(now * capacity)
                waited = (now - _asked(step, sequence)) * capacity
                assert ahead + waited <= 0.030 * capacity
    assert sum(len(data) for data in wire) > 0.97 * 5.0 * capacity


def _asked(step: int, sequence: int) -> float:
    """When the demand with this number was put in: at the last step with that low byte."""
    return (step - ((step - sequence) % 256)) * 0.001
