"""Who drives, through real channels: second links, duplicates with the driver's ids, old frames, restarts and stops.

A twin is another program with the driver's system and component id. "Ours" is a ground station with sessions,
"foreign" one without. Each trace is run again with a second link of the driver, honest and hostile.
"""

from __future__ import annotations

import itertools
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, ControlFlag, Result
from dialects.modes import Mode
from link.core import Peer
from tests.examples import examples
from tests.vehicle.wires import IDS, HostileLinks, Program, SessionProgram, TwoLinks, Wires, drive_fully
from vehicle.drive.conversation import Conversation
from vehicle.drive.driver import SUCCESSION_TIME

AHEAD, BACK, NEUTRAL = Axes(throttle=1.0), Axes(throttle=-1.0), Axes()
SESSIONS = [SessionProgram, TwoLinks, HostileLinks]
KINDS = [Program, *SESSIONS]


def driving(kind: type[Program] = Program, links: int = 1) -> tuple[Wires, Program]:
    """A driver at full throttle: the danger that each trace begins with."""
    wires = Wires(links)
    return wires, drive_fully(kind, wires)


def both(first: Program, one: Axes | None, second: Program, other: Axes | None, seconds: float) -> list[float]:
    """Let two programs send side by side; return the outputs of each cycle."""
    outputs = []

    def each(now: float) -> None:
        first.step(one)
        second.step(other, 23.0)
        outputs.append(first.wires.throttle)

    first.wires.wait(seconds, each)
    return outputs


# ---- 1: two links, one late ----


@pytest.mark.parametrize("lag", [0.1, 0.5, 1.5, 3.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_late_second_link_neither_drives_nor_stops(kind: type[Program], lag: float) -> None:
    wires, driver = driving(kind, links=2)
    late = kind(wires, "gcs by the slow link", link=1, delay=lag, number=77)
    both(driver, AHEAD, late, AHEAD, 2.0)
    assert wires.turning
    outputs = both(driver, NEUTRAL, late, AHEAD, 4.0)
    if lag >= 0.5 or kind is Program:
        assert not any(outputs[50:])  # 1 s after letting go
    both(driver, NEUTRAL, late, NEUTRAL, 4.0)
    both(driver, AHEAD, late, NEUTRAL, 0.2)
    assert wires.throttle > 0.0


@pytest.mark.parametrize("kind", KINDS)
def test_with_the_fast_link_cut_the_late_one_does_not_drive_on(kind: type[Program]) -> None:
    wires, driver = driving(kind, links=2)
    late = kind(wires, "gcs by the slow link", link=1, delay=1.5, number=77)
    if isinstance(late, SessionProgram):
        late.session, late.clock = SessionProgram.session, 5000
    both(driver, AHEAD, late, AHEAD, 2.0)
    late.hold(0.9, AHEAD)
    assert not wires.turning
    late.hold(3.0, AHEAD)
    assert not wires.turning  # of a session for good; a foreign one has shown no neutral


# ---- 2: duplicates ----


@pytest.mark.parametrize("address", ["gcs", "elsewhere"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_twins_neutral_does_not_unlock_a_stick_that_is_held(kind: type[Program], address: str) -> None:
    wires = Wires()
    driver = kind(wires)
    driver.hold(1.0, None)
    driver.arm()
    twin = Program(wires, address, number=128)
    outputs = both(driver, AHEAD, twin, NEUTRAL, 8.0)
    assert not any(outputs)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("twin_kind", KINDS)
def test_a_twin_does_not_drive(kind: type[Program], twin_kind: type[Program]) -> None:
    wires, driver = driving(kind)
    twin = twin_kind(wires, "elsewhere", number=128)
    if isinstance(twin, SessionProgram):
        twin.session = 8
    outputs = both(driver, NEUTRAL, twin, BACK, 5.0)
    assert min(outputs) >= 0.0
    assert not any(outputs[50:])
    assert driver.text("Another program uses your ids 255/190: it may only stop")
    if twin_kind is Program:
        assert twin.text("another program with your ids 255/190")
    driver.hold(0.5, AHEAD)
    assert wires.turning  # the driver has lost nothing


def test_the_driver_is_told_of_a_twin_again_after_a_minute() -> None:
    wires, driver = driving()
    twin = Program(wires, "elsewhere", number=128)
    both(driver, NEUTRAL, twin, NEUTRAL, 50.0)
    told = [message for address, message in wires.sent if address == "gcs" and "your ids" in str(message)]
    assert len(told) == 1
    both(driver, NEUTRAL, twin, NEUTRAL, 20.0)
    told = [message for address, message in wires.sent if address == "gcs" and "your ids" in str(message)]
    assert len(told) == 2


# ---- 3: who is missed ----


@pytest.mark.parametrize("kind", KINDS)
def test_heartbeats_of_a_twin_do_not_keep_the_failsafe_quiet(kind: type[Program]) -> None:
    wires, driver = driving(kind)
    driver.hold(1.0, NEUTRAL)
    twin = Program(wires, "elsewhere", number=128)
    twin.hold(4.0, None)
    assert wires.rover._control.ownership.silence_duration(wires.now) > 3.9
    twin.hold(2.0, None)
    assert wires.mode is Mode.HOLD
    assert not wires.said("drives from another program now")  # heartbeats succeed nobody


# ---- 4, 5: old frames ----


OLD_FRAMES = [
    *itertools.product((Program, SessionProgram), ("gcs",), (1.0,), (1, 5, 8, 11, 30)),
    *itertools.product((Program, SessionProgram), ("gcs",), (20.0, 1000.0), (1, 5, 8, 11, 30, 90)),
    *itertools.product((Program, SessionProgram), ("elsewhere",), (1.0,), (1, 11)),
    *itertools.product((Program, SessionProgram), ("elsewhere",), (20.0, 1000.0), (8, 90)),
    *itertools.product((TwoLinks, HostileLinks), ("gcs", "elsewhere"), (20.0,), (8, 90)),
]
"""Who drives, from where frames come again, at how many per second, and how many."""


@pytest.mark.parametrize(("kind", "address", "rate", "count"), OLD_FRAMES)
def test_old_frames_that_come_again_move_nothing(kind: type[Program], address: str, rate: float, count: int) -> None:
    wires, driver = driving(kind)
    driver.hold(2.0, AHEAD)
    old = [data for _, data in driver.frames[-count:]]
    driver.hold(1.5, NEUTRAL)
    assert not wires.turning
    for number, data in enumerate(old):
        wires.put(data, address, delay=number / rate)
    outputs: list[float] = []

    def each(now: float) -> None:
        driver.step(NEUTRAL)
        outputs.append(wires.throttle)

    wires.wait(count / rate + 1.0, each)
    if kind is Program and address == "gcs" and count / rate > 10.0:
        # U2, see below: each hit is in force for 0.45 s at most, then the ramp ends it. Old frames at 1 Hz hit twice.
        assert sum(output > 0.0 for output in outputs) * 0.02 <= 2 * (0.45 + 0.4)
    else:
        assert not any(outputs)
    driver.hold(1.5, NEUTRAL)
    driver.hold(0.5, AHEAD)
    assert wires.turning


@pytest.mark.parametrize("address", ["gcs", "elsewhere"])
@pytest.mark.parametrize("kind", KINDS)
def test_old_frames_after_the_driver_has_gone_move_nothing(kind: type[Program], address: str) -> None:
    wires, driver = driving(kind)
    old = [data for _, data in driver.frames]
    driver.hold(1.0, NEUTRAL)
    wires.wait(1.0)
    for number, data in enumerate(old):
        wires.put(data, address, delay=number / 20)
    outputs: list[float] = []
    wires.wait(len(old) / 20 + 1.0, lambda now: outputs.append(wires.throttle))
    assert not any(outputs)


def test_copy_at_any_lag_moves_nothing_unless_its_number_is_next() -> None:
    """U2: of a foreign driver, on its own address, what is 256 less 1 to 8 numbers old is taken for the next frame."""
    wires, driver = driving()
    driver.hold(20.0, AHEAD)
    moved = []
    for lag in range(1, 301, 3):
        driver.hold(1.5, NEUTRAL)
        assert not wires.turning
        wires.put(driver.frames[-lag][1], "gcs")
        peak = 0.0
        for _ in range(30):
            wires.wait(0.02, lambda now: driver.step(NEUTRAL))
            peak = max(peak, wires.throttle)
        if peak:
            moved.append(lag)
            assert peak <= 0.3
    assert all(lag % 256 >= 256 - 18 for lag in moved)


# ---- 6: proofs ----


@pytest.mark.parametrize("kind", SESSIONS)
def test_presence_alone_drives_and_demands_alone_do_not(kind: type[SessionProgram]) -> None:
    wires, driver = driving(kind)
    assert isinstance(driver, SessionProgram)
    driver.hold(1.0, NEUTRAL)
    wires.wait(0.5, lambda now: Program.demand(driver, AHEAD))
    assert not wires.turning
    for axes, seconds in ((NEUTRAL, 0.2), (AHEAD, 0.5)):
        for _ in range(round(seconds / 0.02)):
            driver.send(driver.build(axes))
            wires.wait(0.02)
    assert wires.turning


# ---- 7: roaming, restarts, losses ----


@pytest.mark.parametrize(("loss", "tries"), [(0.0, 1), (0.1, 3), (0.2, 6)])
@pytest.mark.parametrize("what", ["restart", "roam", "second link"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_driver_who_comes_back_is_ready_within_a_second(
    kind: type[Program], what: str, loss: float, tries: int
) -> None:
    ready = []
    for seed in range(tries):
        chance = random.Random(seed)
        wires, driver = driving(kind, links=2)
        if what == "restart":
            back = kind(wires, "gcs on a new port")
        else:
            back = kind(wires, "gcs elsewhere", link=int(what == "second link"), number=driver.number)
        if isinstance(back, SessionProgram) and what == "restart":
            back.session = 9
        elif isinstance(back, SessionProgram) and isinstance(driver, SessionProgram):
            back.clock = driver.clock
        start = wires.now
        while not wires.rover._control.neutral_seen or wires.rover._control.demand is None:
            back.step(NEUTRAL, lost=chance.random() < loss)
            wires.wait(0.02)
            assert wires.now - start < 3.0
        ready.append(wires.now - start)
        back.hold(0.3, AHEAD)
        assert wires.turning
    # Foreign: 0.7 s of silence, then three frames, one of which is not a copy, then neutral; losses come on top.
    assert sorted(ready)[tries // 2] <= 1.0
    assert max(ready) <= 1.0 + 10 * loss


@pytest.mark.parametrize("behind", [0, 3, 20, 32])
def test_a_program_restarted_a_little_behind_drives_at_once(behind: int) -> None:
    wires, driver = driving()
    driver.hold(0.5, NEUTRAL)
    wires.wait(1.5)
    held = Program(wires, number=driver.number - 1 - behind & 0xFF)
    push, rest = Axes(throttle=0.9), Axes(steering=0.002)  # the former run has sent neither with these numbers
    held.hold(0.5, push)
    assert wires.said("drives from another program now: release the keys first") == 1
    assert not wires.turning  # a stick that was held all the while
    held.hold(0.1, rest)
    held.hold(0.3, push)
    assert wires.turning
    assert not wires.said("Two programs count")


@settings(max_examples=6, deadline=None)
@given(st.integers(0, 2**32), st.integers(0, 32), st.floats(0.75, 4.0), st.floats(0.0, 0.3))
def test_frames_of_the_former_run_move_nothing_around_a_restart(
    seed: int, behind: int, silence: float, loss: float
) -> None:
    """Copies of its last 33 frames, most with full throttle, while the driver is gone and the next program is idle."""
    chance = random.Random(seed)
    wires, driver = driving()
    driver.hold(0.5, NEUTRAL)
    old = [data for _, data in driver.frames[-33:]]
    back: Program | None = None

    def each(now: float) -> None:
        if back is not None:
            back.step(NEUTRAL, lost=chance.random() < loss)
        if chance.random() < 0.3:
            wires.put(chance.choice(old), driver.address)
        assert not wires.turning

    assert not wires.turning
    wires.wait(silence, each)
    back = Program(wires, number=driver.number - 1 - behind & 0xFF)
    wires.wait(3.0, each)
    back.hold(1.0, NEUTRAL)
    assert back.set_mode(Mode.MANUAL) is Result.ACCEPTED  # silence may have ended in HOLD
    back.hold(0.1, NEUTRAL)
    back.hold(0.3, AHEAD)
    assert wires.turning


@pytest.mark.parametrize("kind", KINDS)
def test_still_older_frames_after_a_restart_move_it_once_at_most(kind: type[Program]) -> None:
    """U3: copies more than 32 numbers old, on the address of a program that has just restarted."""
    for seed in (14, 19, 43, 0, 1):  # the first three move a rover without sessions for 0.1 to 0.44 s
        chance = random.Random(seed)
        wires, driver = driving(kind)
        driver.hold(8.0, AHEAD)
        old = [data for _, data in driver.frames[:-40]]
        driver.hold(1.5, NEUTRAL)
        assert not wires.turning
        wires.wait(chance.uniform(0.75, 2.0))
        back, turned = kind(wires, number=driver.number - 1 - chance.randrange(33) & 0xFF), [False]

        def each(now: float, chance: random.Random = chance, wires: Wires = wires, back: Program = back,
                 turned: list[bool] = turned, old: list[bytes] = old) -> None:  # fmt: skip
            back.step(NEUTRAL)
            if chance.random() < 0.3:
                wires.put(chance.choice(old), "gcs")
            turned.append(wires.throttle > 0.0)

        wires.wait(5.0, each)
        begins = sum(after and not before for before, after in itertools.pairwise(turned))
        assert begins <= (kind is Program)
        assert sum(turned) * 0.02 <= 0.45 + 0.4


def test_a_reconnected_tcp_client_is_the_same_program_in_the_end() -> None:
    wires, driver = driving()
    again = Program(wires, "gcs on a new connection", number=driver.number)
    again.hold(SUCCESSION_TIME - 0.1, NEUTRAL)
    assert not wires.said("drives from another program now")
    again.hold(0.4, NEUTRAL)
    assert wires.said("drives from another program now") == 1


def test_self_driving_does_not_outlive_a_change_of_driver() -> None:
    wires, driver = driving()
    driver.hold(0.5, NEUTRAL)
    wires.rover._safety.mode = Mode.GUIDED
    driver.hold(0.5, NEUTRAL)
    assert [wires.mode] == [Mode.GUIDED]
    Program(wires, "elsewhere").hold(1.5, NEUTRAL)
    assert [wires.mode] == [Mode.HOLD]


def test_a_driver_of_heartbeats_only_is_not_missed_so_soon() -> None:
    wires = Wires()
    driver = Program(wires)
    driver.hold(1.0, None)
    driver.arm()
    driver.hold(3.0, None)
    twin = Program(wires, "elsewhere", number=50)
    outputs = both(driver, None, twin, AHEAD, 5.0)
    assert not any(outputs)
    assert not wires.said("drives from another program now")
    twin.hold(6.5, NEUTRAL)
    assert wires.said("drives from another program now") == 1


# ---- 8: what a twin may not do ----


@pytest.mark.parametrize("kind", KINDS)
def test_a_twin_may_not_command(kind: type[Program]) -> None:
    wires, driver = driving(kind)
    twin = Program(wires, "elsewhere", number=128)
    both(driver, AHEAD, twin, None, 1.5)
    assert twin.set_mode(Mode.MANUAL) is Result.FAILED
    assert twin.command(Command.REQUEST_OPERATOR_CONTROL, 0) is Result.FAILED
    assert twin.command(Command.REQUEST_OPERATOR_CONTROL, 1) is Result.FAILED
    assert twin.arm() is Result.FAILED
    timeout = wires.rover._params["FS_GCS_TIMEOUT"]
    twin.send(m.ParamSet(1, 1, b"FS_GCS_TIMEOUT", 60.0, 9))
    twin.send(m.MissionClearAll(1, 1, 0))
    assert wires.rover._params["FS_GCS_TIMEOUT"] == timeout
    assert twin.text("another program with your ids 255/190")
    driver.hold(0.3, AHEAD)
    assert wires.turning
    assert wires.mode is Mode.MANUAL
    assert driver.set_mode(Mode.HOLD) is Result.ACCEPTED


@pytest.mark.parametrize("kind", KINDS)
def test_a_request_for_control_goes_to_the_driver_not_its_twin(kind: type[Program]) -> None:
    wires, driver = driving(kind)
    twin = Program(wires, "elsewhere", number=128)
    twin.hold(0.1, None)
    other = Program(wires, "other", ids=(254, 190))
    other.hold(0.1, None)
    other.command(Command.REQUEST_OPERATOR_CONTROL, 1)
    asked = [address for address, message in wires.sent if isinstance(message, m.CommandLong)]
    assert len(asked) == len(set(asked)), "over each of its links once"
    assert set(asked) == set(driver.addresses if isinstance(driver, TwoLinks) else (driver.address,))


def test_commands_and_setpoints_of_a_late_link_are_refused() -> None:
    wires, driver = driving(SessionProgram, links=2)
    assert isinstance(driver, SessionProgram)
    late = SessionProgram(wires, "gcs by the slow link", link=1, number=77)
    late.clock = 500
    late.beat()
    for _ in range(60):  # proofs that are 2 s old on arrival
        driver.step(NEUTRAL)
        late.send(late.build(AHEAD, age=2.0))
        wires.wait(0.05)
    assert late.set_mode(Mode.GUIDED) is Result.TEMPORARILY_REJECTED
    assert late.text("this link is 2.0 s late")
    assert wires.mode is Mode.MANUAL
    assert not driver.text("Another program")
    assert wires.rover._control.ownership.setpoint_denial_reason(Conversation(*IDS, *peer_of(late)), wires.now)
    assert (
        wires.rover._control.ownership.setpoint_denial_reason(Conversation(*IDS, *peer_of(driver)), wires.now) is None
    )
    wires.wait(0.5)
    assert (
        wires.rover._control.ownership.setpoint_denial_reason(Conversation(*IDS, *peer_of(driver)), wires.now)
        == "older than OPR_ECHO_MAX on arrival"
    )


def peer_of(program: Program) -> tuple[Peer, int]:
    """The peer and the numbering of a program, as its channel knows them."""
    state = program.wires.channels[program.link]._peers.get(program.address)
    assert state is not None
    return state.peer, state.sources[program.ids].numbering.index


# ---- 9: stops ----


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("stop", ["disarm", "emergency stop", "hold"])
@pytest.mark.parametrize("ids", [(255, 190), (9, 1)])
def test_anybody_may_stop_with_any_number(kind: type[Program], stop: str, ids: tuple[int, int]) -> None:
    wires, driver = driving(kind)
    for number in (0, driver.number, (driver.number - 1) & 0xFF):
        stranger = Program(wires, driver.address if ids == (255, 190) else "stranger", ids=ids, number=number)
        if stop == "disarm":
            stranger.disarm()
        elif stop == "hold":
            stranger.set_mode(Mode.HOLD)
        else:
            stranger.command(Command.DO_SET_SAFETY_SWITCH_STATE, 0)
        assert (wires.mode is Mode.HOLD) if stop == "hold" else not wires.armed
        if stop != "emergency stop":
            driver.hold(1.0, None)
            driver.set_mode(Mode.MANUAL)
            driver.arm()
            driver.hold(0.3, NEUTRAL)
            driver.hold(0.3, AHEAD)
            assert wires.turning


# ---- 11: two programs behind one address ----


def test_crossing_numbers_stop_the_rover_and_both_are_told() -> None:
    wires, driver = driving()
    twin = Program(wires, driver.address, number=(driver.number - 60) & 0xFF)
    outputs: list[float] = []

    def each(now: float) -> None:
        driver.step(NEUTRAL, 10.0)
        twin.step(BACK, 50.0)
        outputs.append(wires.throttle)

    wires.wait(12.0, each)
    assert wires.said("Two programs count as 255/190 behind one address: stopped") >= 1
    # U3: a twin behind the driver's own address may be taken for it once, until the numbers clash.
    assert sum(output < 0.0 for output in outputs) <= 1.4 / 0.02
    driver.hold(1.5, NEUTRAL)
    driver.hold(0.5, AHEAD)
    assert wires.throttle > 0.0


# ---- ROVER_CONTROL ----


def newest_control(driver: Program) -> tuple[int, int, int, ControlFlag]:
    """Session, system, component and flags of the newest ROVER_CONTROL that a program got."""
    message = next(
        each for address, each in reversed(driver.wires.sent)
        if address == driver.address and isinstance(each, m.RoverControl)
    )  # fmt: skip
    return message.session_id, message.driver_system, message.driver_component, ControlFlag(message.flags)


def test_rover_control_names_the_program_in_control() -> None:
    wires, driver = driving(SessionProgram)
    assert newest_control(driver) == (7, 255, 190, ControlFlag(0))
    assert driver.command(Command.REQUEST_OPERATOR_CONTROL, 1, 1) is Result.ACCEPTED
    driver.hold(0.1, NEUTRAL)
    assert newest_control(driver) == (7, 255, 190, ControlFlag.TAKEOVER_ALLOWED)
    wires.wait(0.8)
    assert newest_control(driver)[3] & ControlFlag.SILENT
    driver.hold(0.1, NEUTRAL)
    assert not newest_control(driver)[3] & ControlFlag.SILENT
    driver.command(Command.REQUEST_OPERATOR_CONTROL, 0)
    driver.hold(0.1, None)
    assert newest_control(driver)[:3] == (0, 0, 0)


def test_rover_control_tells_of_clash_of_driver_without_sessions() -> None:
    wires, driver = driving()
    watcher = SessionProgram(wires, "watcher", ids=(254, 190))
    watcher.hold(1.5, None)
    driver.hold(0.1, NEUTRAL)
    assert newest_control(watcher)[:3] == (0, 255, 190)
    twin = Program(wires, driver.address, number=(driver.number - 1) & 0xFF)
    twin.demand(BACK)
    driver.hold(0.1, NEUTRAL)
    assert newest_control(watcher)[3] == ControlFlag.CLASH


# ---- any mix ----


@settings(max_examples=examples(40), deadline=None)
@given(st.integers(0, 2**32), st.floats(0.0, 0.4), st.floats(0.0, 3.0), st.booleans())
def test_a_session_is_moved_by_its_own_fresh_demands_only(seed: int, loss: float, lag: float, same: bool) -> None:
    """Two links, a twin, and copies of everything at random: no output but from a demand of the last 0.45 s.

    The driver asks ahead, the twin back; the ramp from full to neutral takes 0.4 s.
    """
    wires, driver = driving(SessionProgram, links=2)
    assert isinstance(driver, SessionProgram)
    chance = random.Random(seed)
    twin = SessionProgram(wires, "gcs" if same else "elsewhere", number=128)
    twin.session = 8
    moved_at = wires.now

    def each(now: float) -> None:
        nonlocal moved_at
        push = chance.random() < 0.02 or (now - moved_at < 0.1 and chance.random() < 0.8)
        if push:
            moved_at = now
        driver.step(AHEAD if push else NEUTRAL, lost=chance.random() < loss)
        if chance.random() < 0.2:
            twin.demand(BACK)
        if chance.random() < 0.2:
            _, data = chance.choice(driver.frames[-200:])
            wires.put(data, chance.choice(["gcs", "elsewhere"]), chance.choice([0, 1]), chance.uniform(0.0, lag))
        assert wires.throttle >= 0.0
        if now - moved_at > 0.45 + 0.4 + 0.1:
            assert not wires.turning

    wires.wait(12.0, each)
