"""Mistakes on the command lines of the real programs: exit code 2, one line that names the mistake, no traceback.

A vehicle that lacks something that may appear later ends with 1: as a service it is restarted. The text of each message
is tested beside its code. These tests check, in processes of their own, that nothing else is printed. The rows of
tables are forked (tests/forked.py). Other tests start the programs as a user does.
"""

from __future__ import annotations

import fcntl
import os
import pty
import select
import socket
import struct
import subprocess
import sys
import termios
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.forked import Forks
from tests.ports import free_port

pytestmark = [pytest.mark.e2e, pytest.mark.xdist_group("forked programs")]  # one process that forks them

ROOT = Path(__file__).resolve().parents[2]
SIZE = (80, 24)
WITHIN = 60.0
"""s: the start of Python on a busy machine."""


Run = Callable[[list[str], Path], tuple[int, str, str]]
"""Words and an empty folder -> exit code, stdout and stderr."""


def run(words: list[str], folder: Path) -> tuple[int, str, str]:
    """Start a program without a terminal; return exit code, stdout and stderr."""
    done = subprocess.run(
        [sys.executable, "-m", *words],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdin=subprocess.DEVNULL,
        timeout=WITHIN,
        check=False,
    )
    return done.returncode, done.stdout, done.stderr


def run_in_terminal(
    words: list[str], folder: Path, size: tuple[int, int] = SIZE, term: str = "xterm-256color"
) -> tuple[int, str, str]:
    """Do the same in a terminal of this size. Only stderr is not a terminal, so that the two can be told apart."""
    ours, theirs = _open_terminal(size)
    with subprocess.Popen(
        [sys.executable, "-m", *words],
        stdin=theirs,
        stdout=theirs,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        env=_environment(term),
    ) as process:
        os.close(theirs)
        _, complaint = process.communicate(timeout=WITHIN)
    return process.returncode, _drawn(ours), complaint


@pytest.fixture(scope="module")
def forks() -> Iterator[Forks]:
    """The process that forks programs."""
    made = Forks()
    yield made
    made.close()


@pytest.fixture
def fork(forks: Forks, tmp_path: Path) -> Run:
    """Return `run` for a program that is forked. Its files stand for what a pipe would hold back."""

    def run(words: list[str], folder: Path) -> tuple[int, str, str]:
        with (tmp_path / "out").open("w+") as out, (tmp_path / "err").open("w+") as err, open(os.devnull) as nothing:
            environment = os.environ | {"PYTHONPATH": str(ROOT)}
            code = forks.start(words, folder, environment, [each.fileno() for each in (nothing, out, err)]).wait()
        return code, Path(out.name).read_text(), Path(err.name).read_text()

    return run


@pytest.fixture
def fork_in_terminal(forks: Forks, tmp_path: Path) -> Run:
    """Return `run_in_terminal` for a program that is forked."""

    def run(words: list[str], folder: Path) -> tuple[int, str, str]:
        ours, theirs = _open_terminal(SIZE)
        with (tmp_path / "err").open("w+") as err:
            program = forks.start(words, folder, _environment(), [theirs, theirs, err.fileno()])
            os.close(theirs)
            code = program.wait()
        return code, _drawn(ours), Path(err.name).read_text()

    return run


def _open_terminal(size: tuple[int, int]) -> tuple[int, int]:
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
    return ours, theirs


def _environment(term: str = "xterm-256color") -> dict[str, str]:
    """Return what a program in a terminal gets."""
    environment = {key: value for key, value in os.environ.items() if key not in ("COLUMNS", "LINES")}
    return environment | {"PYTHONPATH": str(ROOT), "TERM": term}


def _drawn(terminal: int) -> str:
    """Return what a program has drawn that has ended, and close the terminal."""
    readable = bool(select.select([terminal], [], [], 0)[0]) and _readable(terminal)
    drawn = os.read(terminal, 65536).decode() if readable else ""
    os.close(terminal)
    return drawn


def _readable(terminal: int) -> bool:
    """Return whether there is anything to read. A terminal whose program has ended reports that as an error."""
    (waiting,) = struct.unpack("i", fcntl.ioctl(terminal, termios.FIONREAD, b"\0\0\0\0"))
    return int(waiting) > 0


def assert_one_line(result: tuple[int, str, str], program: str, *names: str, code: int = 2) -> None:
    ended, printed, complaint = result
    assert ended == code, result
    assert printed == ""
    assert complaint.startswith((f"{program}: ", f"mavhelm {program}: ")), complaint  # the log, or the command line
    assert complaint.endswith("\n")
    assert complaint.count("\n") == 1, complaint
    assert "Traceback" not in complaint
    for name in names:
        assert name in complaint


@pytest.fixture
def taken() -> Iterator[dict[str, str]]:
    """Ports of loopback that another socket holds, by the kind of socket."""
    with ExitStack() as stack:
        ports = {}
        for name, kind in (("udp", socket.SOCK_DGRAM), ("tcp", socket.SOCK_STREAM)):
            sock = stack.enter_context(socket.socket(socket.AF_INET, kind))
            sock.bind(("127.0.0.1", 0))
            if kind == socket.SOCK_STREAM:
                sock.listen(1)
            ports[name] = str(sock.getsockname()[1])
        yield ports


ENDPOINTS = [
    ("carrier:pigeon", ["'carrier:pigeon'", "udpin:HOST:PORT", "serial:PATH:BAUD"]),
    ("udpn:127.0.0.1:14550", ["did you mean udpin:127.0.0.1:14550?"]),
    ("127.0.0.1:14550", ["did you mean udpin:127.0.0.1:14550?"]),
    ("udpin:127.0.0.1:abc", ["port 'abc' is not a number from 1 to 65535"]),
    ("serial:/dev/ttyUSB0", ["write serial:PATH:BAUD, for example serial:/dev/ttyAMA0:57600"]),
    ("serial:/dev/ttyUSB0:abc", ["baud rate 'abc' is not a number from 300 to 12000000"]),
]
"""Invalid endpoints -> what the error must name. tests/link/test_endpoint.py has all of them."""
ABSENT = [
    ("serial:/dev/null:57600", ["/dev/null is not a serial port"]),
    ("serial:/etc/passwd:57600", ["/etc/passwd is not a serial port but a file"]),
    ("serial:/tmp:57600", ["/tmp is not a serial port"]),
    ("udpout:no-such-host.invalid:14550", ["no-such-host.invalid", "is not known"]),
    ("tcpout:no-such-host.invalid:14550", ["no-such-host.invalid", "is not known"]),
    ("udpin:192.0.2.1:14550", ["192.0.2.1"]),
]
"""Endpoints that cannot be opened. The last one is an address for documentation only (RFC 5737)."""
NAMES = [endpoint for endpoint, _ in (*ENDPOINTS, *ABSENT)]


@pytest.mark.parametrize(("endpoint", "names"), [*ENDPOINTS, *ABSENT], ids=NAMES)
def test_endpoints_of_the_ground_station(
    endpoint: str, names: list[str], fork_in_terminal: Run, tmp_path: Path
) -> None:
    assert_one_line(fork_in_terminal(["groundstation", endpoint], tmp_path), "mavhelm", *names)


@pytest.mark.parametrize(("endpoint", "names"), ENDPOINTS, ids=[endpoint for endpoint, _ in ENDPOINTS])
def test_endpoints_of_the_vehicle(endpoint: str, names: list[str], fork: Run, tmp_path: Path) -> None:
    assert_one_line(fork(["vehicle", "--sim", endpoint], tmp_path), "vehicle", *names)


@pytest.mark.parametrize(("endpoint", "names"), ABSENT, ids=[endpoint for endpoint, _ in ABSENT])
def test_endpoints_that_the_vehicle_cannot_have(endpoint: str, names: list[str], fork: Run, tmp_path: Path) -> None:
    assert_one_line(fork(["vehicle", "--sim", endpoint], tmp_path), "vehicle", *names, code=1)


@pytest.mark.parametrize("kind", ["udp", "tcp"])
def test_a_port_in_use(kind: str, taken: dict[str, str], tmp_path: Path) -> None:
    endpoint = f"{kind}in:127.0.0.1:{taken[kind]}"
    assert_one_line(run_in_terminal(["groundstation", endpoint], tmp_path), "mavhelm", endpoint, "in use")
    assert_one_line(run(["vehicle", "--sim", endpoint], tmp_path), "vehicle", endpoint, "in use", code=1)


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ("--fly", ["--fly"]),
        ("--speed 9", ["'9'", "0.1 to 1"]),
        ("--speed nan", ["'nan'"]),
        ("--system 0", ["'0'", "1 to 255"]),
        ("--system 300", ["'300'", "1 to 255"]),
        ("--system", ["--system"]),
        ("--keys emacs", ["'emacs'", "standard, teleop"]),
        ("--keys /nowhere/keys.toml", ["/nowhere/keys.toml", "no such file", "choose standard, teleop"]),
        ("--master udp:127.0.0.1:14550", ["--master", "write the endpoint without an option, e.g. udpin:"]),
        ("--baud 57600 /dev/ttyUSB0", ["--baud", "write serial:PATH:BAUD, e.g. serial:/dev/ttyUSB0:57600"]),
        ("--theme solarized", ["'solarized'", "'dark', 'light'"]),
        ("--speed 60", ["'60'", "0.1 to 1", "60 % is 0.6"]),
        ("--dialect none.xml", ["none.xml", "no such file", "name the XML file"]),
        ("help", ["did you mean --help?"]),
        ("drve", ["did you mean `mavhelm drive`?"]),
        ("attach", ["no station runs here", "`mavhelm` or `mavhelm serve --headless` starts one"]),
        ("replay none.tlog", ["none.tlog", "no such file", "name a telemetry log"]),
        ("replay /etc/passwd", ["/etc/passwd", "is not a telemetry log"]),
        ("export none.tlog --csv out", ["none.tlog", "no such file", "name a telemetry log"]),
        ("export /etc/passwd --csv out", ["/etc/passwd", "is not a telemetry log"]),
        ("--style wild", ["'wild'", "hold"]),
        ("--log-file /nowhere/station.log", ["/nowhere/station.log", "No such file"]),
        ("--log-file /tmp", ["/tmp", "directory"]),
    ],
)
def test_options_of_the_ground_station(words: str, names: list[str], fork_in_terminal: Run, tmp_path: Path) -> None:
    assert_one_line(fork_in_terminal(["groundstation", *words.split()], tmp_path), "mavhelm", *names)


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ("--sim --fly", ["--fly"]),
        ("chek rover.toml", ["'chek'", "did you mean `mavhelm vehicle check`?"]),
        ("help", ["'help'", "did you mean mavhelm vehicle --help?"]),
        ("--config none.toml", ["none.toml", "No such file", "`mavhelm vehicle init none.toml` writes a template"]),
        ("--sim --system 0", ["'0'", "1 to 255"]),
        ("--sim --system 300", ["'300'", "1 to 255"]),
        ("--sim --param SPEED=9", ["'SPEED'"]),
        ("--sim --param SPEED_MAX=fast", ["SPEED_MAX", "'fast'"]),
        ("--sim --log-file /nowhere/vehicle.log", ["/nowhere/vehicle.log", "No such file"]),
        ("--sim --motor-log /nowhere/motors.log", ["/nowhere/motors.log", "No such file"]),
        ("--sim --sim-truth /nowhere/truth.log", ["/nowhere/truth.log", "No such file"]),
        ("--sim --walls none.geojson", ["none.geojson", "No such file"]),
        ("--motors nonsense udpout:127.0.0.1:14550", ["'nonsense'", "simulated", "module:Class"]),
        ("--motors no_such_module:Motors udpout:127.0.0.1:14550", ["no_such_module"]),
        ("--motors os:Nothing udpout:127.0.0.1:14550", ["os:Nothing"]),
        ("--motors simulated", ["endpoint"]),
        ("udpout:127.0.0.1:14550", ["--motors", "--sim"]),
    ],
)
def test_options_of_the_vehicle(words: str, names: list[str], fork: Run, tmp_path: Path) -> None:
    assert_one_line(fork(["vehicle", *words.split()], tmp_path), "vehicle", *names)


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ("--config bridge.toml", ["unknown option --config"]),
        ("--tlg logs udpin:127.0.0.1:14550", ["unknown option --tlg", "did you mean --tlog?"]),
        ("doctr udpin:127.0.0.1:14550", ["'doctr'", "did you mean `mavhelm bridge doctor`?"]),
        ("udpin:127.0.0.1:14550", ["two endpoints or more are needed, for example serial:"]),
    ],
)
def test_command_lines_of_the_bridge(words: str, names: list[str], fork: Run, tmp_path: Path) -> None:
    assert_one_line(fork(["link.bridge", *words.split()], tmp_path), "bridge", *names)


@pytest.mark.parametrize(
    ("scheme", "names"),
    [
        ("tcpout:127.0.0.1:{port}", ["not connected (Connection refused)"]),
        ("udpout:127.0.0.1:{port}", ["refused: nothing listens there"]),
        ("udpin:127.0.0.1:{port}", ["nothing arrives; a vehicle must send to UDP port {port} of this computer"]),
        ("serial:/dev/ttyUSB{port}:57600", ["waiting for /dev/ttyUSB{port}, it is not there; is it plugged in?"]),
    ],
)
def test_a_verb_says_why_it_hears_no_vehicle(scheme: str, names: list[str], fork: Run, tmp_path: Path) -> None:
    port = free_port()
    endpoint = scheme.format(port=port)
    result = fork(["groundstation", "status", "--wait", "2", "-e", endpoint], tmp_path)
    says = [name.format(port=port) for name in names]
    assert_one_line(result, "mavhelm", f"no vehicle on {endpoint} within 2 s", *says, code=3)


def test_a_terminal_that_cannot_place_text(tmp_path: Path) -> None:
    result = run_in_terminal(["groundstation", "udpin:127.0.0.1:14999"], tmp_path, term="dumb")
    assert_one_line(result, "mavhelm", "TERM=dumb", "run mavhelm in a terminal such as xterm or tmux")


def test_not_a_terminal(tmp_path: Path) -> None:
    assert_one_line(run(["groundstation", "udpin:127.0.0.1:14999"], tmp_path), "mavhelm", "is not a terminal")


def test_a_terminal_that_is_too_small(tmp_path: Path) -> None:
    result = run_in_terminal(["groundstation", "udpin:127.0.0.1:14999"], tmp_path, size=(38, 9))
    assert_one_line(result, "mavhelm", "38x9", "at least 40x10, better 80x24")


def test_a_key_map_that_is_no_toml(tmp_path: Path) -> None:
    (tmp_path / "keys.toml").write_text("[keys\n")
    assert_one_line(run_in_terminal(["groundstation", "--keys", "keys.toml"], tmp_path), "mavhelm", "keys.toml")
