"""A rover behind a router with certificates: the router freezes, dies and returns; strangers and watchers try to drive.

Each test first sees the wheels turn.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import zenoh

from dialects import messages as m
from dialects.axes import build_manual_control
from dialects.enums import Command
from tests.e2e.fleet_driver import AHEAD, FALL, MAN_TIMEOUT, NEUTRAL, Driver, Fleet
from tests.link.frames import frame
from tests.waits import Waits

pytestmark = [pytest.mark.slow, pytest.mark.e2e, pytest.mark.xdist_group("fleet")]  # one fleet for all tests

RECONNECTED_WITHIN = 1.0
"""s from a router that listens to the next frame; programs ask for it every 0.2 s (link/fleet/probe.py)."""
LATE = 0.2
"""s that the machine may delay the vehicle without a failsafe of it."""
BACK_WITHIN = 1.0
"""s from the next frame to a command that is obeyed."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Fleet]:
    with ExitStack() as stack:
        yield Fleet(tmp_path_factory.mktemp("fleet"), stack)


@pytest.fixture
def fleet(made: Fleet) -> Fleet:
    made.drive()
    return made


def test_frozen_router_stops_wheels_and_old_frames_move_nothing(fleet: Fleet) -> None:
    wires, vehicle = fleet.wires, fleet.wires.vehicle
    waits = Waits(vehicle.process.pid)
    frozen = wires.now
    fleet.router.freeze()
    wires.wait(2.0, lambda now: fleet.driver.step(AHEAD))  # all of it waits in the router and the sockets
    wires.wait(2.0, lambda now: fleet.driver.step(NEUTRAL))
    falls, stood = vehicle.falls_and_stops_after(frozen)
    assert falls <= MAN_TIMEOUT + 0.1 + waits.total()
    assert stood <= MAN_TIMEOUT + FALL + waits.total()

    thawed = wires.now
    fleet.router.thaw()
    back = fleet.next_frame()
    assert fleet.regain() - back <= BACK_WITHIN + waits.total()
    wires.wait(1.0, lambda now: fleet.driver.step(NEUTRAL))
    assert not vehicle.moved_since(thawed)
    fleet.accelerate()


def test_a_router_that_is_killed_and_restarted(fleet: Fleet) -> None:
    wires, vehicle = fleet.wires, fleet.wires.vehicle
    waits = Waits(vehicle.process.pid)
    killed = wires.now
    fleet.router.kill()
    wires.wait(2.0, lambda now: fleet.driver.step(AHEAD))
    falls, stood = vehicle.falls_and_stops_after(killed)
    assert falls <= MAN_TIMEOUT + 0.1 + waits.total()
    assert stood <= MAN_TIMEOUT + FALL + waits.total()
    assert "lost" in (wires.transport("alice").problem or "")

    fleet.router.start()
    started = wires.now
    back = fleet.next_frame()
    assert back - started <= RECONNECTED_WITHIN + waits.total()
    assert fleet.regain() - back <= BACK_WITHIN + waits.total()
    fleet.accelerate()
    assert wires.transport("alice").problem is None


def test_wrong_certificate_neither_steers_nor_speaks_for_another(fleet: Fleet) -> None:
    wires, vehicle = fleet.wires, fleet.wires.vehicle
    wires.until(vehicle.stands, lambda now: fleet.driver.step(NEUTRAL))
    stood = wires.now
    seen: list[str] = []
    arm = frame(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
    drive = frame(build_manual_control(AHEAD, 1))
    base = "fleet/farm/rover1"
    with fleet.session("bob") as bob, fleet.session("rover2") as rover2:
        bob.declare_subscriber(f"{base}/up/alice/**", lambda each: seen.append(str(each.key_expr)))
        rover2.declare_subscriber(f"{base}/down/**", lambda each: seen.append(str(each.key_expr)))
        before, refused = len(wires.sent), wires.transport("alice").refused

        def forge(now: float) -> None:
            fleet.driver.step(NEUTRAL)
            for name in ("bob/1", "alice/1"):
                for role in ("watch", "drive"):
                    bob.put(f"{base}/down/{name}/{role}/ctl/MANUAL_CONTROL", drive)
                    bob.put(f"{base}/down/{name}/{role}/cmd/COMMAND_LONG", arm)
                    bob.put(f"{base}/down/{name}/{role}/ctl/HEARTBEAT", drive)
            lie = frame(m.Heartbeat(10, 3, 129, 4, 4, 3), 0, 1, 1)
            rover2.put(f"{base}/up/{wires.transport('alice')._keys.me}/ctl/HEARTBEAT", lie)

        wires.wait(1.5, forge)
    assert len(wires.sent) > before
    assert seen == []
    assert not vehicle.moved_since(stood)
    assert wires.transport("alice").refused == refused
    assert all(each.custom_mode != 4 for _, each in wires.sent[before:] if isinstance(each, m.Heartbeat))
    fleet.accelerate()


def test_a_watcher_sees_and_stops(fleet: Fleet) -> None:
    wires, vehicle = fleet.wires, fleet.wires.vehicle
    watcher = Driver(wires, "bob", ids=(254, 190))  # type: ignore[arg-type]

    def both(now: float) -> None:
        fleet.driver.step(AHEAD)
        watcher.step(None)

    wires.until(lambda: any(who == "bob" for who, _ in wires.sent), both)
    fleet.accelerate()
    watcher.command(Command.COMPONENT_ARM_DISARM, 0)
    wires.until(vehicle.stands, lambda now: fleet.driver.step(NEUTRAL))
    assert not fleet.armed()
    watcher.command(Command.COMPONENT_ARM_DISARM, 1)
    wires.wait(1.0, lambda now: fleet.driver.step(NEUTRAL))
    assert not fleet.armed()


def test_a_watcher_stops_by_hold_and_downloads_a_log_to_its_end(fleet: Fleet) -> None:
    """Its certificate grants watch only: these frames need drive unless the vehicle is ours and nobody downloads."""
    wires, vehicle = fleet.wires, fleet.wires.vehicle
    watcher = Driver(wires, "bob", ids=(254, 190))  # type: ignore[arg-type]
    refusal = wires.transport("bob").refusal

    def both(now: float) -> None:
        fleet.driver.step(AHEAD)
        watcher.step(None)

    wires.until(lambda: any(who == "bob" and isinstance(each, m.Heartbeat) for who, each in wires.sent), both)
    fleet.accelerate()
    for allowed in (m.SetMode(1, 1, 4), m.LogRequestEnd(1, 1), m.MissionAck(1, 1, 0)):
        assert refusal(frame(allowed)) is None
    for refused in (m.SetMode(1, 1, 0), m.RequestDataStream(1, 1, 0, 4, 1)):
        assert refusal(frame(refused)) == "the certificate of bob may watch only; ask for the role drive"
    wires.transport("bob").send(frame(m.SetMode(1, 1, 4)), "rover1")
    wires.until(vehicle.stands, lambda now: fleet.driver.step(AHEAD))


def test_a_put_of_60_mb_by_a_watcher_fills_no_memory(fleet: Fleet) -> None:
    """It may publish under this key; a MAVLink frame has at most 280 bytes."""
    wires, vehicle = fleet.wires, fleet.wires.vehicle
    processes = (fleet.router.process.pid, vehicle.process.pid)
    before = [peak_memory(pid) for pid in processes]
    key = "fleet/farm/rover1/down/bob/1/watch/rel/PARAM_REQUEST_LIST"
    with fleet.session("bob", waits=True) as bob:
        for size in (1 << 10, 60_000, 60 << 20):
            bob.put(key, bytes(size), congestion_control=zenoh.CongestionControl.BLOCK)
            wires.wait(1.0, lambda now: fleet.driver.step(AHEAD))
    fleet.accelerate()  # this process drives, too, and so long a put may have held it up
    for pid, peak in zip(processes, before, strict=True):
        assert peak_memory(pid) < peak + (20 << 20)
    assert "too long for a frame" in vehicle.errors.read_text()


def peak_memory(pid: int) -> int:
    """Return the most bytes that a process has had in memory."""
    return int(re.findall(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())[0]) << 10


def test_many_tokens_at_once_do_not_hold_up_the_router(fleet: Fleet) -> None:
    """They need more room than there is in the queue of the session to which they go."""
    wires, base = fleet.wires, "fleet/farm/rover2/gcs/bob"
    waits = Waits(wires.vehicle.process.pid)
    seen: set[str] = set()
    with fleet.session("bob") as bob, fleet.session("rover2") as rover2:
        live = rover2.liveliness()
        tokens = [bob.liveliness().declare_token(f"{base}/{number:0100}") for number in range(500)]
        fleet.accelerate()
        wires.longest_silence = 0.0
        heard = live.declare_subscriber(f"{base}/*", lambda each: seen.add(str(each.key_expr)), history=True)
        wires.until(lambda: len(seen) == len(tokens), lambda now: fleet.driver.step(AHEAD), within=5.0 + waits.total())
        assert heard
    assert wires.longest_silence < 1.0 + waits.total()
    if waits.total() < LATE:
        assert wires.vehicle.at_full()


def test_a_member_who_is_not_in_the_file_reaches_nobody(fleet: Fleet) -> None:
    wires = fleet.wires
    wires.transport("bob")
    wires.until(lambda: any(who == "bob" for who, _ in wires.sent), lambda now: fleet.driver.step(AHEAD))
    text = (fleet.folder / "fleet.toml").read_text()
    (fleet.folder / "fleet.toml").write_text(text[: text.index("[operators.bob]")])
    fleet.router.kill()
    fleet.router.start()
    fleet.next_frame()
    before = len(wires.sent)
    wires.wait(2.0, lambda now: fleet.driver.step(NEUTRAL))
    assert not any(who == "bob" for who, _ in wires.sent[before:])
    assert "may do nothing" in fleet.router.log.read_text()
