"""Every verb of the table with our vehicle, and with vehicles as ArduPilot and PX4 answer, on real sockets.

Each runs through a station. Those that stop, arm, drive or change a mode, and one of each other service, also run over
a link of their own, and over one that loses a fifth of the frames each way. A new verb needs a line.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import pytest

from groundstation.station_socket.connect import running_stations
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.table import VERBS
from tests.e2e.programs import Vehicle
from tests.e2e.relay import Relay
from tests.fakes.params import Param
from tests.fakes.services import ARDUPILOT, PX4, foreign_vehicle
from tests.groundstation.formats.test_plan_file import as_text, document
from tests.groundstation.verbs.setup.test_doctor import INTERVAL, MAG_CAL_START, channels, progress, report, send_all
from tests.groundstation.verbs.test_examples import prepare
from tests.groundstation.verbs.verb_runs import LONG_PATIENCE, run_verb
from tests.ports import free_port
from tests.waits import wait_until

pytestmark = pytest.mark.e2e
LOSS = 0.2
OTHERS = {"ArduPilot": ARDUPILOT, "PX4": PX4}


Prepared = tuple[tuple[str, str], Callable[[bool], None]]
"""The options of a verb for a vehicle, and what arms it, or disarms it."""


@dataclass(frozen=True)
class Line:
    """A command line of a verb. `codes`: vehicle -> its exit code; 0 for the others."""

    words: str
    codes: Mapping[str, int] = field(default_factory=dict)
    armed: bool = False


def line(words: str, *, armed: bool = False, **codes: int) -> tuple[Line, ...]:
    return (Line(words, codes, armed),)


LINES: dict[str, tuple[Line, ...]] = {
    "status": line("status"), "vehicles": line("vehicles --for 0.2"), "links": line("links --for 0.2"),
    "arm": line("arm --wait 20"), "disarm": line("disarm", armed=True), "stop": line("stop", armed=True),
    "estop": (*line("estop", armed=True), *line("estop --clear")),
    "control request": line("control request"), "control show": line("control show"),
    "control release": line("control release"), "doctor": line("doctor"),
    "control give": line("control give 200", ours=7, ArduPilot=7, PX4=7),
    "drive": line("drive --throttle 20 --for 0.3", armed=True),
    "turn": line("turn 20", armed=True, ArduPilot=4, PX4=4),
    "goto": line("goto --by 3 0", armed=True), "home": line("home", armed=True), "speed": line("speed 0.6", armed=True),
    "messages": line("messages --for 0.2"), "watch": line("watch HEARTBEAT.type --until '>=0' --timeout 10"),
    "send": line("send STATUSTEXT severity=INFO text=hello"), "record": line("record out.tlog --for 1.5 --yes"),
    "command": line("command GET_HOME_POSITION"), "request": line("request HOME_POSITION"),
    "rate": line("rate ATTITUDE 5"), "ping": line("ping --count 1 --interval 0.05"),
    "param get": line("param get FS_TIMEOUT"), "param set": line("param set FS_TIMEOUT 2"),
    "param save": line("param save rover.param --yes"), "param diff": line("param diff rover.param"),
    "param load": line("param load rover.param"), "param store": line("param store", ours=4),
    "param reset": line("param reset --yes"),
    "mission put": line("mission put patrol.plan"), "mission show": line("mission show"),
    "mission get": line("mission get got.plan --yes"), "mission check": line("mission check got.plan"),
    "mission start": line("mission start", armed=True), "mission pause": line("mission pause", armed=True),
    "mission jump": line("mission jump 1", armed=True), "mission clear": line("mission clear"),
    "fence put": line("fence put patrol.plan"), "fence show": line("fence show"),
    "fence get": line("fence get got.plan --yes"), "fence check": line("fence check patrol.plan"),
    "fence on": line("fence on"), "fence off": line("fence off"), "fence clear": line("fence clear"),
    "rally put": line("rally put patrol.plan"), "rally show": line("rally show"),
    "rally get": line("rally get got.plan --yes"), "rally check": line("rally check patrol.plan"),
    "rally clear": line("rally clear"),
    "modes": line("modes"), "mode": line("mode HOLD"), "reboot": line("reboot", ours=4),
    "motor": line("motor 1 10 --for 1.5"),
    "calibrate": (
        *line("calibrate gyro"), *line("calibrate compass", ours=4, PX4=4), *line("calibrate sticks --for 1.5", ours=5),
    ),
    "ftp put": line("ftp put a.lua /a.lua", ours=4), "ftp ls": line("ftp ls /"),
    "ftp crc": line("ftp crc /a.lua", ours=4),
    "ftp get": line("ftp get /a.lua b.lua --yes", ours=4), "ftp rm": line("ftp rm /a.lua", ours=4),
    "log list": line("log list"), "log get": line("log get latest log.bin --yes", ours=7),
    "log erase": line("log erase --yes"),
}  # fmt: skip
"""Verb and action -> what is run, in an order in which each finds what it needs."""
ELSEWHERE = {
    "api": "api/test_api.py", "mcp": "agents/test_server.py", "export": "files/test_export.py",
    "ros1": "ros/test_ros1.py", "ros2": "ros/test_ros2.py",
    "sign": "setup/test_sign.py", "takeoff": "control/test_flight.py", "land": "control/test_flight.py",
}  # fmt: skip
"""Verb without a vehicle, for a copter, with one on a cable, or that needs another program -> its test."""
EVERYWHERE = (
    "status", "arm", "disarm", "stop", "estop", "control request", "control release", "control give", "drive", "turn",
    "goto", "home", "speed", "watch", "send", "request", "ping", "param set", "param save", "mission put",
    "mission get", "mission start", "mission pause", "mission jump", "fence on", "mode", "motor", "calibrate",
    "ftp put", "ftp get", "log get",
)  # fmt: skip
"""What also runs without a station. Others are of the same services (parameters, plans, files, logs, messages), and
test_examples.py and the tests of their rooms run them over a link of their own."""
SECOND_PART = EVERYWHERE.index("mission put")
"""What comes from SECOND_PART on needs nothing of what is before it."""
LOST = (5, 8)
"""Codes of `ping`, which repeats nothing, on a lossy link."""
STOOD_STILL = "stood still"
"""What `drive` says on a machine with so much to do that its watchdog had to act. An upload to ArduPilot may fail where
frames are lost: its MISSION_ACK comes once, and it answers a last item that is repeated with an error. At 20 % loss six
tries of a command are all lost once in 500."""
UNARMED_BY = ("disarm", "estop")
PX4_MANUAL, PX4_LOITER, PX4_RTL = 1 << 16, 3 << 24 | 4 << 16, 5 << 24 | 4 << 16
"""custom_mode of modes of PX4."""
STICKS = (channels(1100, 1500), channels(1900, 1500))
MOTORS = {"SERVO1_FUNCTION": Param(73.0), "SERVO3_FUNCTION": Param(74.0)}


def test_every_verb_has_a_line() -> None:
    names = {f"{verb} {action}".strip() for verb in VERBS.keys() - ELSEWHERE for action in VERBS[verb].actions}
    assert names == LINES.keys()
    assert all((Path(__file__).parent / test).exists() for test in ELSEWHERE.values())


def runs() -> Iterator[object]:
    """Yield each vehicle with each way to it. What loses frames takes long, and is run in two parts at once."""
    for name in ("ours", *OTHERS):
        yield pytest.param(name, "through", (*LINES,), id=f"{name} through")
        yield pytest.param(name, "own link", EVERYWHERE, id=f"{name} own link", marks=pytest.mark.slow)
        for number, part in enumerate((EVERYWHERE[:SECOND_PART], EVERYWHERE[SECOND_PART:]), 1):
            yield pytest.param(name, "lossy", part, id=f"{name} lossy {number}", marks=pytest.mark.slow)


@pytest.mark.parametrize(("name", "way", "part"), [*runs()])
def test_every_verb(name: str, way: str, part: Sequence[str], here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with ExitStack() as stack:
        vehicle = _our_vehicle if name == "ours" else partial(_vehicle_of_others, name)
        options, prepare_arming = vehicle(stack, way, here, capsys)
        assert run_all(name, options, capsys, prepare_arming, lossy=way == "lossy", part=part) == ""


def _our_vehicle(stack: ExitStack, way: str, here: Path, capsys: pytest.CaptureFixture[str]) -> Prepared:
    """Start our vehicle; return the options of a verb for it, and what arms it."""
    if way == "lossy":
        relay = Relay(loss=LOSS)
        stack.callback(relay.close)
        port, options = relay.vehicle_port, ("-e", f"udpin:127.0.0.1:{relay.ground_port}")
    else:
        port = free_port()
        options = _options(stack, way, f"udpin:127.0.0.1:{port}")
    vehicle = Vehicle(here, port, "--param", "FS_TIMEOUT=10", "--param", "FENCE_ACTION=0")
    stack.callback(vehicle.end)

    def prepare_arming(armed: bool) -> None:
        for words in (("arm", "--wait", "30"),) if armed else (("stop",), ("disarm",)):
            assert run_verb(capsys, *words, *options, "-v", "1").code == 0

    return options, prepare_arming


def _vehicle_of_others(
    name: str, stack: ExitStack, way: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> Prepared:
    """Start one that answers as ArduPilot or PX4 does."""
    loss = LOSS if way == "lossy" else 0.0
    vehicle = stack.enter_context(foreign_vehicle(OTHERS[name], loss=loss, loss_in=loss))
    prepare(vehicle)
    vehicle.params |= MOTORS
    vehicle.on_command[MAG_CAL_START] = partial(send_all, vehicle, *(4 * (progress(40),)), *(4 * (report(4),)))
    vehicle.on_command[INTERVAL] = partial(send_all, vehicle, *(4 * STICKS))
    if OTHERS[name] == PX4:
        vehicle.modes[:] = [("MANUAL", PX4_MANUAL, 0), ("HOLD", PX4_LOITER, 0), ("RTL", PX4_RTL, 0)]
        vehicle.on_command[192] = partial(vehicle.change_mode, PX4_LOITER)
        vehicle.on_command[20] = partial(vehicle.change_mode, PX4_RTL)
    options = _options(stack, way, vehicle.endpoint)

    def prepare_arming(armed: bool) -> None:
        vehicle.change_mode(PX4_MANUAL if OTHERS[name] == PX4 else 0, armed=armed)
        seen = ("watch", "HEARTBEAT.base_mode", "--until", ">=128" if armed else "<128", "--timeout", "30")
        assert run_verb(capsys, *seen, *options).code == 0, "the station has not heard it"

    return options, prepare_arming


def _options(stack: ExitStack, way: str, endpoint: str) -> tuple[str, str]:
    return stack.enter_context(station(endpoint)) if way == "through" else ("-e", endpoint)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder in which verbs run, with the files that they read."""
    monkeypatch.chdir(tmp_path)
    Path("a.lua").write_text("-- a script\n")
    Path("patrol.plan").write_text(as_text(document()))
    return tmp_path


@contextmanager
def station(endpoint: str) -> Iterator[tuple[str, str]]:
    """Run a station without a screen; yield the options of a verb that goes through it."""
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", endpoint]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        try:
            wait_until(lambda: process.pid in running_stations(), "the station does not start")
            yield "--station", str(process.pid)
        finally:
            process.terminate()


def run_all(
    kind: str,
    options: Sequence[str],
    capsys: pytest.CaptureFixture[str],
    prepare_arming: Callable[[bool], None],
    *,
    lossy: bool,
    part: Sequence[str],
) -> str:
    """Run the lines of a part; return those that ended with another code than theirs, and what they said."""
    failed, armed = "", False
    for each in [line for verb in part for line in LINES[verb]]:
        if each.armed != armed:
            prepare_arming(each.armed)
        armed = each.armed and each.words not in UNARMED_BY
        wait = (5 if lossy else 1.5) if each.words.startswith("control give") else 60
        words = (*shlex.split(each.words), *options, "-v", "1", "--wait", f"{wait}")
        ended, deadline = run_verb(capsys, *words), time.monotonic() + LONG_PATIENCE
        while STOOD_STILL in ended.err and time.monotonic() < deadline:  # as a person would
            ended = run_verb(capsys, *words)
        for _ in range(2):
            unanswered = ended.code == ExitCode.NO_ANSWER != each.codes.get(kind, 0)
            unseen = each.words.startswith("calibrate sticks") and ended.code == ExitCode.DIFFERS
            unfinished = kind == "ArduPilot" and ended.code and "put" in words
            if (unseen and not each.codes.get(kind, 0)) or (lossy and (unanswered or unfinished)):
                ended = run_verb(capsys, *words)
        lost = lossy and each.words.startswith("ping") and ended.code in LOST
        if ended.code != each.codes.get(kind, 0) and not lost:
            failed += f"{each.words}: {ended.code} {ended.err}"
    return failed
