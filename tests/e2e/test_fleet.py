"""A rover behind a router with certificates: the router freezes, dies and returns; strangers and watchers try to drive.

Each test first sees the wheels turn.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import zenoh

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command
from dialects.modes import Mode
from link.endpoint import parse_endpoint
from link.fleet.config import load_config
from tests.e2e.fleet_programs import FleetWires, RouterProcess, make_fleet
from tests.link.frames import frame
from tests.vehicle.wires import SessionProgram
from tests.waits import Waits

pytestmark = [pytest.mark.slow, pytest.mark.e2e, pytest.mark.xdist_group("fleet")]  # one fleet for all tests

AHEAD, NEUTRAL = Axes(throttle=1.0), Axes()
MAN_TIMEOUT = 0.45
FALL = 0.55
"""s from the end of the demand to wheels at rest: docs/safety.md allows 1 s from the last demand."""

RECONNECTED_WITHIN = 1.0
"""s from a router that listens to the next frame; programs try again every 0.5 s (RETRY in link/fleet/config.py)."""
BACK_WITHIN = 1.0
"""s from the next frame to a command that is obeyed."""


class Driver(SessionProgram):
    """An operator of the fleet with a session, who echoes the time of the vehicle."""

    def build(self, axes: Axes | None, *, age: float = 0.02) -> m.RoverOperatorPresence:
        proof = super().build(axes)
        proof.echo_time_boot_ms = self.wires.boot_ms[1] if self.wires.boot_ms else 0  # type: ignore[attr-defined]
        return proof


class Fleet:
    """One vehicle that alice drives."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.folder = make_fleet(folder, rover1="vehicle", rover2="vehicle", alice="drive", bob="watch")
        self.router = RouterProcess(self.folder, stack)
        self.wires = FleetWires(folder, self.folder, stack)
        self.driver = Driver(self.wires, "alice")  # type: ignore[arg-type]
        self.wires.transport("alice")
        self.wires.until(lambda: self.wires.boot_ms is not None, lambda now: self.driver.step(None))

    def drive(self) -> None:
        """Begin a test: armed, at full throttle."""
        self.rest()
        while not self.armed():
            self.driver.arm()
            self.wires.wait(0.3, lambda now: self.driver.step(NEUTRAL))
        self.regain()
        self.wires.until(self.wires.vehicle.at_full, lambda now: self.driver.step(AHEAD))

    def rest(self) -> None:
        self.wires.wait(0.6, lambda now: self.driver.step(NEUTRAL))

    def regain(self) -> float:
        """Choose MANUAL, as a person does after a stop; return when the vehicle obeyed."""
        before, due = len(self.wires.sent), 0.0
        while not any(_accepts(each) for who, each in self.wires.sent[before:] if who == "alice"):
            if self.wires.now >= due:
                due = self.wires.now + 0.1
                self.driver.set_mode(Mode.MANUAL)
            self.wires.wait(0.02, lambda now: self.driver.step(NEUTRAL))
        return self.wires.now

    def armed(self) -> bool:
        beats = [each for who, each in self.wires.sent[-2000:] if isinstance(each, m.Heartbeat)]
        return bool(beats) and bool(beats[-1].base_mode & 128)

    def next_frame(self) -> float:
        """Wait for the next frame of the vehicle; return when it came: the link is back."""
        before = len(self.wires.sent)
        self.wires.until(lambda: len(self.wires.sent) > before, lambda now: self.driver.step(NEUTRAL))
        return self.wires.now

    def session(self, name: str) -> zenoh.Session:
        """Return a session with the certificate of a member, and no manners."""
        is_vehicle = "rover" in name
        endpoint = parse_endpoint(f"zenoh:{self.folder}/{name}.json5/farm{f'/{name}' if is_vehicle else ''}")
        return zenoh.open(load_config(endpoint).zenoh)


def _accepts(message: m.Message) -> bool:
    return isinstance(message, m.CommandAck) and (message.command, message.result) == (Command.DO_SET_MODE, 0)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Fleet]:
    with ExitStack() as stack:
        yield Fleet(tmp_path_factory.mktemp("fleet"), stack)


@pytest.fixture
def fleet(made: Fleet) -> Fleet:
    made.drive()
    return made


def test_a_frozen_router_stops_the_wheels_and_what_it_kept_moves_nothing(fleet: Fleet) -> None:
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
    wires.until(vehicle.at_full, lambda now: fleet.driver.step(AHEAD), within=5.0 + waits.total())


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
    fleet.rest()
    wires.until(vehicle.at_full, lambda now: fleet.driver.step(AHEAD))
    assert wires.transport("alice").problem is None


def test_nobody_steers_or_speaks_for_another_with_a_wrong_certificate(fleet: Fleet) -> None:
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
    wires.until(vehicle.turning, lambda now: fleet.driver.step(AHEAD))


def test_a_watcher_sees_and_stops(fleet: Fleet) -> None:
    wires, vehicle = fleet.wires, fleet.wires.vehicle
    watcher = Driver(wires, "bob", ids=(254, 190))  # type: ignore[arg-type]

    def both(now: float) -> None:
        fleet.driver.step(AHEAD)
        watcher.step(None)

    wires.until(lambda: any(who == "bob" for who, _ in wires.sent), both)
    assert vehicle.turning()
    watcher.command(Command.COMPONENT_ARM_DISARM, 0)
    wires.until(vehicle.stands, lambda now: fleet.driver.step(NEUTRAL))
    assert not fleet.armed()
    watcher.command(Command.COMPONENT_ARM_DISARM, 1)
    wires.wait(1.0, lambda now: fleet.driver.step(NEUTRAL))
    assert not fleet.armed()


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
