"""Python programs that drive with Rover: every way in which they end, with the motor log as ground truth."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from itertools import groupby, pairwise
from pathlib import Path

import pytest

from groundstation.intents.driving import Stop
from groundstation.intents.session import GiveUpKeys
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import RequestControl
from groundstation.station_socket.connect import running_stations
from tests.e2e.programs import Vehicle
from tests.groundstation.screen import Screen
from tests.ports import free_port
from tests.waits import Waits, wait_for_end, wait_until

pytestmark = [pytest.mark.e2e, pytest.mark.xdist_group("programs")]

PATROL = Path(__file__).parents[2] / "docs" / "examples" / "patrol.plan"
TRIES = 8
"""Calls that drive, of which a late machine may end each."""
LONG = 8.0
"""s for which a call drives that is never to reach its end."""
HEAD = """\
import gc, os, signal, sys, threading, time
from groundstation import Rover
from groundstation.rover import *

def say(text):
    print(text, flush=True)

# Again where a late machine has ended a call: the program or that of its connection stood still, or the vehicle, which
# has disarmed.
def insist(call, *values, **named):
    for left in reversed(range({tries})):
        try:
            return call(*values, **named)
        except RoverError as error:
            if not left or not any(late in str(error) for late in ("stood still", "is disarmed after")):
                raise
            if "is disarmed after" in str(error):
                rover.arm(30)

sys.stdin = os.fdopen(os.pipe()[0])
signal.signal(signal.SIGUSR1, lambda *_: breakpoint())
rover = Rover(*{endpoints!r}, vehicle=1, wait=30)
"""
DRIVE = f"""\
with rover:
    rover.arm(30)
    insist(rover.drive, 0.5, seconds={LONG})
"""


class Program:
    """A Python program in a process of its own."""

    def __init__(self, folder: Path, endpoint: str, text: str) -> None:
        path = folder / "program.py"
        path.write_text(HEAD.format(endpoints=[endpoint] if endpoint else [], tries=TRIES) + text)
        self._out, self._err = folder / "program.out", folder / "program.err"
        with self._out.open("wb") as out, self._err.open("wb") as err:
            self.process = subprocess.Popen(
                [sys.executable, str(path)], stdin=subprocess.DEVNULL, stdout=out, stderr=err, start_new_session=True
            )

    @property
    def said(self) -> str:
        """What it has printed."""
        return self._out.read_text()

    @property
    def errors(self) -> str:
        """What it has printed to stderr."""
        return self._err.read_text()

    def children(self) -> list[int]:
        """Return the processes that it has started."""
        path = Path(f"/proc/{self.process.pid}/task")
        return [int(each) for task in path.iterdir() for each in (task / "children").read_text().split()]

    def end(self) -> None:
        """End it in any state."""
        for number in (signal.SIGKILL, signal.SIGCONT):
            try:
                os.killpg(self.process.pid, number)
            except ProcessLookupError:
                break
        self.process.wait()


class Road:
    """A simulated rover and the programs that drive it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.port = free_port()
        self.endpoint = f"udpin:127.0.0.1:{self.port}"
        self.vehicle = Vehicle(folder, self.port)
        self.programs: list[Program] = []

    def start(self, text: str) -> Program:
        """Start a program."""
        folder = self.folder / str(len(self.programs))
        folder.mkdir()
        self.programs.append(Program(folder, self.endpoint, text))
        return self.programs[-1]

    def start_driving(self, text: str = DRIVE) -> Program:
        """Start a program, and see that it turns the wheels."""
        program = self.start(text)
        wait_until(self.vehicle.turning, lambda: f"turning: {program.errors}")
        return program

    def see_it_stop(self) -> None:
        """See the wheels stop long before the call that drives would end; the delays of the machine are added."""
        processes = (self.vehicle.process.pid, *running_stations(), *(each.process.pid for each in self.programs))
        waits, began = Waits(*processes), time.monotonic()
        wait_until(self.vehicle.stands, lambda: f"standing: {self.programs[-1].errors}")
        took = self.vehicle.outputs()[-1].at - began
        assert took <= LONG / 2 + waits.total(), f"{took:.1f} s, {waits.total():.1f} s late: {self.programs[-1].errors}"

    def is_disarmed(self) -> bool:
        """Return whether the newest that the vehicle tells of arming is that it has disarmed."""
        told = self.vehicle.errors.read_text()
        return told.rfind("Disarmed") > told.rfind("Armed by")

    def end(self) -> None:
        """End all processes."""
        for each in self.programs:
            each.end()
        self.vehicle.end()


@pytest.fixture
def road(tmp_path: Path) -> Iterator[Road]:
    road = Road(tmp_path)
    yield road
    road.end()


def kill(program: Program) -> None:
    os.kill(program.process.pid, signal.SIGKILL)


def interrupt(program: Program) -> None:
    os.kill(program.process.pid, signal.SIGINT)


def terminate(program: Program) -> None:
    os.kill(program.process.pid, signal.SIGTERM)


def freeze(program: Program) -> None:
    os.kill(program.process.pid, signal.SIGSTOP)


def reach_a_breakpoint(program: Program) -> None:
    os.kill(program.process.pid, signal.SIGUSR1)
    wait_until(lambda: "(Pdb)" in program.said, lambda: program.errors)


def kill_the_connection(program: Program) -> None:
    for pid in program.children():
        os.kill(pid, signal.SIGKILL)


def freeze_the_connection(program: Program) -> None:
    for pid in program.children():
        os.kill(pid, signal.SIGSTOP)


def test_a_call_that_drives_ends_with_its_program(road: Road) -> None:
    """Frozen programs and killed connections: the tests below."""
    for way in (kill, interrupt, terminate, reach_a_breakpoint):
        see_it_end(road, way)  # the next program waits for the port: the watchdog of the one before disarms


def see_it_end(road: Road, way: Callable[[Program], None]) -> None:
    """Let a program of its own drive, end it in one way, and see the wheels stop."""
    program = road.start_driving()
    way(program)
    road.see_it_stop()
    program.end()


def test_a_program_that_goes_on_does_not_drive_on(road: Road) -> None:
    frozen = road.folder / "frozen"
    program = road.start_driving(f"""\
with rover:
    rover.arm(30)
    while not os.path.exists({str(frozen)!r}):
        try:
            rover.drive(0.5, seconds={LONG})
        except RoverError as error:
            problem = error
    say(problem)
    time.sleep(2)
    say(time.monotonic())
    insist(rover.drive, 0.5, seconds={LONG})
""")
    frozen.touch()
    freeze(program)
    road.see_it_stop()
    stopped = time.monotonic()
    os.kill(program.process.pid, signal.SIGCONT)
    wait_until(lambda: road.vehicle.moved_since(stopped), lambda: f"the next call drives: {program.errors}")
    problem, called = program.said.splitlines()
    assert "stood still" in problem
    assert not any(each.turning for each in road.vehicle.outputs() if stopped < each.at < float(called))


def test_the_program_is_told_that_its_connection_was_killed(road: Road) -> None:
    program = road.start_driving()
    kill_the_connection(program)
    road.see_it_stop()
    assert wait_for_end(program.process) == 1
    assert "Disconnected: mavhelm has ended: SIGKILL" in program.errors, program.errors
    assert "Event loop is closed" not in program.errors, program.errors


def test_the_program_is_told_that_its_connection_stands_still(road: Road) -> None:
    program = road.start_driving()
    freeze_the_connection(program)
    road.see_it_stop()
    assert wait_for_end(program.process) == 1
    assert "Disconnected: mavhelm has not answered for 5 s" in program.errors


BETWEEN_LINES = {
    "an exception": ("    raise RuntimeError('mistake')", "RuntimeError: mistake"),
    "an exit": ("    sys.exit(3)", ""),
    "os._exit": ("    os._exit(3)", ""),
    "kill -9 of itself": ("    os.kill(os.getpid(), signal.SIGKILL)", ""),
}


@pytest.mark.parametrize("line", BETWEEN_LINES)
def test_a_program_that_ends_between_calls_leaves_it_disarmed(road: Road, line: str) -> None:
    text, error = BETWEEN_LINES[line]
    driven = "with rover:\n    rover.arm(30)\n    insist(rover.drive, 0.5, seconds=0.5)\n    say('driven')\n"
    program = road.start(f"{driven}{text}\n")
    assert wait_for_end(program.process) != 0
    assert "driven" in program.said, program.errors
    assert error in program.errors
    assert any(each.turning for each in road.vehicle.outputs())
    road.see_it_stop()
    wait_until(lambda: "Disarmed" in road.vehicle.errors.read_text(), "disarmed")


def test_nothing_moves_between_two_calls(road: Road) -> None:
    program = road.start("""\
with rover:
    rover.arm(30)
    insist(rover.drive, 0.5, seconds=0.5)
    say(time.monotonic())
    time.sleep(3)
    say(time.monotonic())
""")
    assert wait_for_end(program.process) == 0, program.errors
    driven, left = map(float, program.said.split())
    outputs = road.vehicle.outputs()
    assert any(each.turning for each in outputs)
    assert not any(each.turning for each in outputs if driven < each.at < left)


def test_the_interpreter_ends_while_a_thread_drives(road: Road) -> None:
    program = road.start_driving(f"""\
rover.open()
rover.arm(30)
threading.Thread(target=insist, args=(rover.drive, 0.5), kwargs={{"seconds": {LONG}}}, daemon=True).start()
rover.wait_for(lambda state: state.speed and state.speed > 0.1, 30)
sys.exit(0)
""")
    road.see_it_stop()
    assert wait_for_end(program.process) == 0, program.errors


def test_a_stop_of_another_thread_ends_a_call_that_drives(road: Road) -> None:
    program = road.start_driving(f"""\
with rover:
    rover.arm(30)
    def stop():
        rover.wait_for(lambda state: state.speed and state.speed > 0.1, 30)
        rover.stop()
        say(rover.mode)
    thread = threading.Thread(target=stop)
    thread.start()
    try:
        insist(rover.drive, 0.5, seconds={LONG})
    except RoverError as error:
        say(error)
    thread.join()
""")
    road.see_it_stop()
    assert wait_for_end(program.process) == 0, program.errors
    assert set(program.said.split()) == {"cancelled", "HOLD"}


def test_a_thread_that_waits_keeps_no_call_of_another_driving(road: Road) -> None:
    program = road.start_driving(f"""\
with rover:
    rover.arm(30)
    threading.Thread(target=rover.wait_for, args=(lambda state: False, 60), daemon=True).start()
    insist(rover.drive, 0.5, seconds={LONG})
""")
    reach_a_breakpoint(program)
    road.see_it_stop()


def test_two_threads_drive_one_after_the_other(road: Road) -> None:
    program = road.start("""\
with rover:
    rover.arm(30)
    threads = [threading.Thread(target=insist, args=(rover.drive, each), kwargs={"seconds": 1}) for each in (0.5, -0.5)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
""")
    assert wait_for_end(program.process) == 0, program.errors
    assert program.errors == ""
    ways = [(power > 0) - (power < 0) for power in (sum(each.throttles) for each in road.vehicle.outputs())]
    signs = [sign for sign, _ in groupby(ways)]
    assert {1, -1} <= set(signs), "both have turned the wheels"
    assert all(0 in pair for pair in pairwise(signs)), "neutral between the two"


def test_a_fork_neither_drives_nor_keeps_the_vehicle_driving(road: Road) -> None:
    program = road.start_driving(f"""\
rover.open()
rover.arm(30)
if os.fork() == 0:
    try:
        insist(rover.drive, 0.5, seconds={LONG})
    except RoverError as error:
        say(error)
    time.sleep(60)
    os._exit(0)
insist(rover.drive, 0.5, seconds={LONG})
""")
    wait_until(lambda: "a fork opens its own" in program.said, lambda: program.errors)
    kill(program)
    road.see_it_stop()
    wait_until(lambda: "Disarmed" in road.vehicle.errors.read_text(), "disarmed, because its program has ended")


def test_a_rover_that_is_forgotten_is_disarmed(road: Road) -> None:
    program = road.start("""\
rover.open()
rover.arm(30)
insist(rover.drive, 0.5, seconds=0.5)
del rover
say("forgotten")
time.sleep(60)
""")
    wait_until(lambda: "forgotten" in program.said, lambda: program.errors)
    assert any(each.turning for each in road.vehicle.outputs())
    assert program.children() == []
    wait_until(lambda: "Disarmed" in road.vehicle.errors.read_text(), "disarmed")


@pytest.fixture
def station(road: Road) -> Iterator[subprocess.Popen[bytes]]:
    """A station without a screen, through which the programs of the road go."""
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", road.endpoint]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wait_until(lambda: running_stations() == [process.pid], "the station runs")
    road.endpoint = ""
    yield process
    for number in (signal.SIGCONT, signal.SIGTERM):
        process.send_signal(number)
    process.wait()


@pytest.mark.usefixtures("station")
def test_through_a_station_a_call_ends_with_its_program(road: Road) -> None:
    for way in (kill, interrupt, freeze):
        see_it_end(road, way)
        wait_until(road.is_disarmed, "the station disarms it, before the next program arms it")


def test_a_station_that_is_killed_ends_the_call(road: Road, station: subprocess.Popen[bytes]) -> None:
    program = road.start_driving()
    station.kill()
    road.see_it_stop()
    assert wait_for_end(program.process) == 1
    assert "rover.errors." in program.errors


def test_a_person_at_a_screen_ends_the_call(road: Road, station: subprocess.Popen[bytes]) -> None:
    program = road.start_driving(f"""\
with rover:
    rover.arm(30)
    try:
        insist(rover.drive, 0.5, seconds={LONG})
    except NotInControl as error:
        say(error)
""")
    with Screen.attach(station.pid, "screen of a test"):
        road.see_it_stop()
        wait_until(lambda: "the screen of a test drives" in program.said, lambda: program.errors)


ENDED_BY: tuple[tuple[AnyIntent, str], ...] = (
    (Stop(), "a person has stopped it at a screen"),
    (RequestControl(), "the screen of a test drives"),
)
"""What a screen does, and what the program is told."""


def test_a_program_drives_while_a_screen_watches_and_ends_it(road: Road, station: subprocess.Popen[bytes]) -> None:
    for intent, why in ENDED_BY:
        see_a_screen_end_it(road, station, intent, why)


def see_a_screen_end_it(road: Road, station: subprocess.Popen[bytes], intent: AnyIntent, why: str) -> None:
    """Let a program drive beside a screen that watches, which then ends it."""
    with Screen.attach(station.pid, "screen of a test") as screen:
        screen.see(lambda seen: not seen.lease.driver and seen.vehicle is not None)
        screen.client.send(GiveUpKeys())
        screen.see(lambda seen: seen.lease.driver == "no screen")
        program = road.start_driving(f"""\
with rover:
    rover.arm(30)
    for _ in range(2):
        try:
            insist(rover.drive, 0.5, seconds={LONG})
        except RoverError as error:
            say(f"{{type(error).__name__}}: {{error}}")
""")
        screen.client.send(intent)
        road.see_it_stop()
        assert wait_for_end(program.process) == 0, program.errors
        assert program.said.startswith(f"NotInControl: {why}")
        assert len(program.said.splitlines()) == 2, "the second call fails, too"
        assert road.vehicle.stands(), "the second call turns no wheel"
        screen.see(lambda seen: seen.vehicle is not None and not seen.vehicle.armed)


@pytest.mark.usefixtures("station")
def test_a_second_program_sets_a_parameter_and_does_not_drive(road: Road) -> None:
    """Where a call of the first one has ended, as on a late machine, the second may drive until the first goes on."""
    driving = road.folder / "driving"
    second = road.start(f"""\
with rover:
    say("open")
    while not os.path.exists({str(driving)!r}):
        time.sleep(0.01)
    rover.params["WP_RADIUS"] = 2.5
    say(rover.params["WP_RADIUS"])
    for _ in range({TRIES}):
        try:
            rover.drive(-1.0, seconds=0.3)
            say("driven")
        except RoverError as error:
            say(f"{{type(error).__name__}}: {{error}}")
            if type(error) is NotInControl:
                break
""")
    wait_until(lambda: "open" in second.said, lambda: second.errors)
    first = road.start_driving(f"""\
with rover:
    while True:
        rover.arm(30)
        try:
            rover.drive(0.5, seconds={LONG})
            say("driven")
        except RoverError as error:
            say(error)
""")
    driving.touch()
    assert wait_for_end(second.process) == 0, second.errors
    _, radius, *refused = second.said.splitlines()
    assert radius == "2.5"
    assert refused[-1].startswith("NotInControl: the mavhelm api"), second.said
    wait_until(road.vehicle.turning, lambda: f"the first one drives on: {first.errors}")
    if not first.said:
        assert len(refused) == 1
        assert all(value >= 0 for each in road.vehicle.outputs() for value in each.throttles)


DRIVE_ON = """\
with rover:
    rover.arm(30)
    while not os.path.exists({enough!r}):
        insist(rover.drive, 0.5, seconds=1)
    say(rover.armed)
"""
INTRUDER = """\
rover = Rover("udpout:127.0.0.1:{port}", vehicle=1, wait=30)
with rover:
    for name, call in dict(
        drive=lambda: rover.drive(-1.0, seconds=1),
        turn=lambda: rover.turn(90),
        goto=lambda: rover.goto(0.001, 0.001),
        home=lambda: rover.home(),
        mission=lambda: rover.start_mission(),
        mode=lambda: rover.set_mode("AUTO"),
        params=lambda: rover.params.__setitem__("WP_RADIUS", 2.5),
    ).items():
        try:
            say(f"{{name}}: {{call()}}")
        except RoverError as error:
            say(f"{{name}}: {{type(error).__name__}}: {{error}}")
    say(rover.params["WP_RADIUS"] == 2.5)
    say(rover.armed)
"""


def test_a_program_cannot_drive_an_armed_rover_of_somebody_else(road: Road) -> None:
    port = free_port()
    road.vehicle.end()
    road.vehicle = Vehicle(road.folder, road.port, f"udpin:127.0.0.1:{port}")
    enough = road.folder / "enough"
    first = road.start_driving(DRIVE_ON.format(enough=str(enough)))
    second = road.start(INTRUDER.format(port=port))
    assert wait_for_end(second.process) == 0, second.errors
    assert first.process.poll() is None, first.errors
    *answers, is_set, armed = second.said.splitlines()
    assert [each.split(": ")[0] for each in answers] == ["drive", "turn", "goto", "home", "mission", "mode", "params"]
    for each in answers:
        assert each.split(": ")[1] in ("NotInControl", "Refused"), second.said
        assert "GCS 254" in each, second.said
    assert armed == "True", "its end does not disarm what somebody else has armed"
    assert is_set == "False"
    enough.touch()
    assert wait_for_end(first.process) == 0, first.errors
    assert first.said == "True\n"
    assert all(value >= 0 for each in road.vehicle.outputs() for value in each.throttles)


def test_a_vehicle_that_falls_silent_ends_the_call(road: Road) -> None:
    program = road.start_driving(f"""\
with rover:
    rover.arm(30)
    try:
        insist(rover.drive, 0.5, seconds={LONG})
    except RoverError as error:
        say(type(error).__name__)
""")
    road.vehicle.process.send_signal(signal.SIGSTOP)
    wait_until(lambda: program.said == "LinkLost\n", lambda: f"{program.said} {program.errors}")
    road.vehicle.process.send_signal(signal.SIGCONT)
    road.see_it_stop()


ASYNC = """\
import asyncio

async def again(call):
    for left in reversed(range({tries})):
        try:
            return await call()
        except RoverError as error:
            if "stood still" not in str(error) or not left:
                raise

async def main():
    async with AsyncRover({endpoint!r}, vehicle=1, wait=30) as rover:
        await rover.arm(30)
        await again(lambda: rover.drive(0.5, seconds=0.5))
        assert await again(lambda: rover.turn(45)) > 20
        await rover.wait_for(lambda state: state.speed < 0.05, 30)
        seen = []
        async for fields in rover.messages("ATTITUDE", hz=20):
            seen.append(fields["yaw"])
            if len(seen) == 3:
                break
        place = rover.position
        await rover.upload(Mission.through([(place.latitude + 1e-3, place.longitude)]))
        assert len((await rover.download(Mission)).items) == 1
        await rover.start_mission()
        await rover.wait_for(lambda state: state.mode == "AUTO" and state.speed > 0.1, 30)
        await rover.pause_mission()
        await rover.goto(place.latitude - 1e-3, place.longitude)
        await rover.wait_for(lambda state: state.mode == "GUIDED" and state.speed > 0.1, 30)
        await rover.stop()
        assert rover.mode == "HOLD"
        await rover.set_param("WP_RADIUS", 2.5)
        assert await rover.get_param("WP_RADIUS") == 2.5
        for wrong in (
            lambda: rover.get_param("NO_SUCH"), lambda: rover.set_param("WP_RADIUS", -1), lambda: rover.set_mode("FLY"),
            lambda: rover.wait_for(lambda state: False, 0.2), lambda: rover.drive(2, seconds=1),
        ):
            try:
                await wrong()
            except RoverError as error:
                say(type(error).__name__)
        driving = asyncio.create_task(again(lambda: rover.drive(0.5, seconds=9)))
        await rover.wait_for(lambda state: state.mode == "MANUAL" and state.speed > 0.1, 30)
        driving.cancel()
        await asyncio.wait([driving])
        say(driving.cancelled())
        await rover.wait_for(lambda state: state.speed < 0.05, 30)
        say(time.monotonic())
        await asyncio.sleep(1)
        say(time.monotonic())

asyncio.run(main())
"""


def test_coroutines_do_what_the_calls_do(road: Road) -> None:
    program = road.start(ASYNC.format(tries=TRIES, endpoint=road.endpoint))
    assert wait_for_end(program.process) == 0, program.errors
    *errors, cancelled, began, ended = program.said.split()
    assert errors == ["Differs", "Refused", "Refused", "NoAnswer", "InvalidCall"]
    assert cancelled == "True"
    outputs = road.vehicle.outputs()
    assert any(each.turning for each in outputs if each.at < float(began))
    assert not any(each.turning for each in outputs if float(began) < each.at < float(ended))


def test_a_program_leaves_nothing_open(road: Road) -> None:
    program = road.start(f"""\
import warnings
warnings.simplefilter("always")
with rover:
    say(rover.mode)
rover.open()
rover.close()
del rover
try:
    Rover("udpin:127.0.0.1:{free_port()}", wait=0.1).open()
except NoVehicle as error:
    say(error)
with Rover.simulated() as rover:
    say(rover.mode)
del rover
gc.collect()
sys.stdin.close()
""")
    assert wait_for_end(program.process) == 0, program.errors
    assert "no vehicle" in program.said
    assert program.errors == ""


def test_plans_are_values_and_files(road: Road, tmp_path: Path) -> None:
    program = road.start(f"""\
os.chdir({str(tmp_path)!r})
with rover:
    place = rover.wait_for(lambda state: state.position, 30).position
    assert rover.mission.items == ()
    mission = Mission.through([(place.latitude + 1e-4, place.longitude), (place.latitude, place.longitude + 1e-4)])
    rover.mission = mission
    assert rover.mission == mission
    rover.mission.save("a.plan"), rover.mission.save("a.waypoints")
    assert Mission.load("a.plan") == Mission.load("a.waypoints") == mission
    rover.fence = Fence.load({str(PATROL)!r})
    assert len(rover.fence.items) == 4 and rover.rally.items == ()
    rover.mission = Mission()
    assert rover.mission.items == ()
    try:
        Rally.load("a.plan")
    except InvalidCall as error:
        say(error)
""")
    assert wait_for_end(program.process) == 0, program.errors
    assert program.said == "a.plan: no rally in it\n"


def test_a_simulated_rover_is_not_remembered(road: Road, tmp_path: Path) -> None:
    program = road.start(f"""\
os.environ["XDG_STATE_HOME"] = {str(tmp_path / "state")!r}
with Rover.simulated() as rover:
    say(rover.mode)
with Rover({road.endpoint!r}, vehicle=1) as rover:
    say(rover.mode)
""")
    assert wait_for_end(program.process) == 0, program.errors
    recent = (tmp_path / "state" / "mavhelm" / "recent.json").read_text()
    assert road.endpoint in recent
    assert recent.count("udpin") == 1
