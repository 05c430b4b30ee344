"""Every way to press stop, with the real programs, and what is in its way; wheels turn first, then they stand.

docs/safety.md has the table. A full product of presses and obstacles would be the same code many times over, so the
rows cover each mechanism with each front end once: the blind stop (nobody is heard), the choice of the target (a
companion, two components), the confirmation by each sender (two vehicles with one id), the form of the command
(COMMAND_INT), and the way past a station that hangs, has ended or takes no more programs.
"""

from __future__ import annotations

import math
import os
import signal
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from dialects import codec
from dialects import messages as m
from dialects.enums import Command
from groundstation.station_socket.folder import list_sockets
from link.runtime.local_socket import open_socket
from tests.e2e.stop_rows import NOISE, STOPS_WITHIN, Crowd, Pressed, Rover, Row, Stands, Station, companion, start
from tests.e2e.test_in_tmux import Tmux, tmux
from tests.e2e.tmux_marks import NEEDS_TMUX
from tests.groundstation.screen import children
from tests.ports import free_port
from tests.vehicle.bench import BEAT
from tests.waits import Waits, wait_until

__all__ = ["tmux"]

pytestmark = pytest.mark.e2e

VERBS = {"disarm": "is disarmed", "stop": "holds", "estop": "has stopped"}
"""Verb -> what it says when the vehicle has confirmed it."""
STOPS = (Command.COMPONENT_ARM_DISARM, Command.DO_SET_MODE, Command.DO_SET_SAFETY_SWITCH_STATE)
ANSWER_WITHIN = 0.5
"""s for a station to answer a stop."""
PRESSED_AGAIN = 5.0
"""s for a key to open the line, before it is pressed again."""
BRIDGE_PLACES = 140
"""More than a link of a bridge has."""


@pytest.fixture
def stack(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ExitStack]:
    """What is ended with the test. Its stations are alone in their runtime folder."""
    for name in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME"):
        monkeypatch.setenv(name, str(tmp_path))
    with ExitStack() as stack:
        yield stack


def options(row: Row) -> list[str]:
    return [word for endpoint in row.endpoints for word in ("-e", endpoint)]


def press_all(row: Row, stack: ExitStack, through: str) -> None:
    """Press each verb with links of its own, then the verb `through` by a running station."""
    for verb, done in VERBS.items():
        row.drive()
        assert done in Pressed(verb, *options(row), "--station", "never").stops(row)
    station = Station(stack, row.endpoints)
    row.drive()
    assert VERBS[through] in Pressed(through, "--station", str(station.process.pid)).stops(row)


def test_strangers_that_hold_all_places(stack: ExitStack, tmp_path: Path) -> None:
    press_all(Crowd(stack, tmp_path), stack, "estop")


def test_a_companion_that_is_heard_first(stack: ExitStack) -> None:
    press_all(Stands(stack, Rover(), first=companion()), stack, "stop")


def test_two_autopilots_of_one_system_one_takes_command_int_only(stack: ExitStack) -> None:
    press_all(Stands(stack, Rover(int_only=True), Rover(component=2)), stack, "disarm")


@pytest.mark.parametrize("verb", VERBS)
def test_one_of_two_vehicles_with_one_id_is_deaf_for_a_while(stack: ExitStack, verb: str) -> None:
    deaf, other = Rover(), Rover()
    row = Stands(stack, deaf, other)
    row.drive()
    deaf.deaf = True
    pressed = Pressed(verb, *options(row))
    wait_until(lambda: not other.moves, "the other one stands")
    deaf.hold_on()
    wait_until(lambda: pressed.process.poll() is not None or time.monotonic() > pressed.began + 3.0)
    assert pressed.process.poll() is None, "it goes on while one of them drives"
    deaf.hold_on()
    assert deaf.moves
    deaf.deaf = False
    assert VERBS[verb] in pressed.stops(row, later=time.monotonic() - pressed.began)


def test_a_bridge_whose_places_strangers_hold(stack: ExitStack) -> None:
    rover, port = Rover(), free_port()
    row = Stands(stack, rover)
    start(stack, "link.bridge", f"udpin:127.0.0.1:{port}", rover.endpoint, "--quiet")
    crowd = [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(BRIDGE_PLACES)]
    wait_until(lambda: rover.of("HEARTBEAT"), "the bridge runs", each=lambda: greet(crowd[0], port, 0))
    for number, each in enumerate(crowd):
        greet(each, port, number)
    for verb, done in VERBS.items():
        row.drive()
        assert done in Pressed(verb, "-e", f"udpout:127.0.0.1:{port}").stops(row)


def greet(stranger: socket.socket, port: int, number: int) -> None:
    """Send one HEARTBEAT."""
    data = codec.frame(m.Heartbeat.id, codec.encode_payload(BEAT), 0, 10 + number, 190)
    stranger.sendto(data, ("127.0.0.1", port))
    time.sleep(0.001)  # a burst would overrun the socket's buffer


@pytest.mark.parametrize(("verb", "lost"), [("stop", signal.SIGSTOP), ("disarm", signal.SIGKILL)])
def test_a_station_is_lost_while_a_stop_goes_through_it(stack: ExitStack, verb: str, lost: signal.Signals) -> None:
    rover = Rover()
    row = Stands(stack, rover)
    station = Station(stack, row.endpoints)
    row.drive()
    rover.silent_on.update(STOPS)
    pressed = Pressed(verb)
    wait_until(lambda: any(rover.commands(each) for each in STOPS), "the stop passes the station")
    station.process.send_signal(lost)
    lost_at = time.monotonic()
    rover.silent_on.clear()
    said = pressed.stops(row, later=lost_at - pressed.began + ANSWER_WITHIN)
    assert "this stop opens links of its own" in said
    assert VERBS[verb] in said


@pytest.mark.parametrize("verb", VERBS)
def test_a_stop_goes_through_each_of_several_stations(stack: ExitStack, verb: str) -> None:
    row, other = Stands(stack, Rover()), Stands(stack, Rover())
    for each in (row, other):
        Station(stack, each.endpoints)
    row.drive()
    other.drive()
    said = Pressed(verb, "--wait", "1").stops(row)
    assert "this stop goes through each" in said
    assert said.count(VERBS[verb]) == 2
    wait_until(lambda: not other.turning(), "the vehicle of the other station stops")


def test_a_station_that_hangs_and_takes_no_more_programs(stack: ExitStack) -> None:
    row = Stands(stack, Rover())
    station = Station(stack, row.endpoints)
    os.kill(station.process.pid, signal.SIGSTOP)
    for verb in ("estop", "disarm"):
        row.drive()
        assert VERBS[verb] in Pressed(verb, *options(row)).stops(row, later=ANSWER_WITHIN)
        fill_socket(stack)


def fill_socket(stack: ExitStack) -> None:
    """Connect to the station until its queue is full."""
    ((_, path),) = list_sockets()
    while True:
        caller = stack.enter_context(open_socket())
        caller.setblocking(False)
        try:
            caller.connect(str(path))
        except BlockingIOError:
            return


def test_a_station_that_hangs_with_the_port_of_the_vehicle(stack: ExitStack) -> None:
    """Nobody else can have the port; the stop says so, and goes out as soon as the station has ended."""
    row = Stands(stack, Rover(), line="udpin")
    station = Station(stack, row.endpoints)
    row.drive()
    station.process.send_signal(signal.SIGSTOP)
    pressed = Pressed("estop", *options(row))
    said = pressed.read_line()
    assert "is in use" in said
    assert f"trying on. If station {station.process.pid} hangs: kill -9 {station.process.pid}" in said
    assert row.turning()
    station.process.kill()
    assert VERBS["estop"] in pressed.stops(row, later=time.monotonic() - pressed.began)


@pytest.mark.tmux
@NEEDS_TMUX
def test_the_emergency_key_where_no_vehicle_is_heard(
    tmux: Callable[..., Tmux], stack: ExitStack, tmp_path: Path
) -> None:
    row = Crowd(stack, tmp_path)
    row.drive()
    terminal = tmux(80, 24, *row.endpoints)
    see(terminal, row, lambda screen: "waiting for a vehicle" in screen)
    if not row.turning():  # a late machine has ended the drive
        row.drive()
    press(terminal, row, "!")
    see(terminal, row, lambda screen: "EMERGENCY STOP" in screen)


@pytest.mark.tmux
@NEEDS_TMUX
def test_lines_with_a_companion_and_two_vehicles_of_one_id(tmux: Callable[..., Tmux], stack: ExitStack) -> None:
    row = Stands(stack, Rover(), Rover(int_only=True), first=companion())
    row.drive()
    terminal = tmux(100, 30, *row.endpoints)
    see(terminal, row, lambda screen: "ArduPilot rover 1" in screen and "ARMED" in screen)
    for verb, said in (("disarm", "rover 1 is disarmed"), ("stop", "rover 1 holds"), ("estop", "rover 1: emergency")):
        row.drive()
        see(terminal, row, lambda screen: "ESC closes" not in screen)
        open_line(terminal, row)
        terminal.press(*verb)
        see(terminal, row, lambda screen, verb=verb: f":{verb}" in screen)  # type: ignore[misc]
        press(terminal, row, "Enter")
        see(terminal, row, lambda screen, said=said: said in screen)  # type: ignore[misc]


def open_line(terminal: Tmux, row: Row) -> None:
    """Press `:` until the line is open: one that still waits for an answer takes only stops.

    What is typed behind it in the same read is lost.
    """
    pressed_at = -math.inf

    def is_open(screen: str) -> bool:
        nonlocal pressed_at
        if "ESC closes" not in screen and time.monotonic() - pressed_at > PRESSED_AGAIN:
            terminal.press(":")
            pressed_at = time.monotonic()
        return "ESC closes" in screen

    see(terminal, row, is_open)


def see(terminal: Tmux, row: Row, condition: Callable[[str], bool]) -> None:
    """Wait for a screen, while the vehicles drive on."""
    wait_until(lambda: condition(terminal.screen()), terminal.screen, each=row.step)


def processes_at(tty: str) -> list[int]:
    """Return the ids of the processes that read from a terminal, and of their children."""
    found = []
    for each in Path("/proc").glob("[0-9]*/fd/0"):
        with suppress(OSError):  # it has ended
            found += [int(each.parts[2])] if os.readlink(each) == tty else []
    return [*found, *(child for each in found for child in children(each))]


def press(terminal: Tmux, row: Row, *keys: str) -> None:
    """Press keys, and check that the wheels stop in time."""
    assert row.turning()
    waits = Waits(*processes_at(terminal.tty))
    terminal.press(*keys)
    typed = time.monotonic()  # tmux has written them to the terminal; its own start is not of the program
    wait_until(lambda: not row.turning(), terminal.screen, each=row.step)
    assert row.stopped_at() - typed <= STOPS_WITHIN + NOISE + waits.total()
