"""`mavhelm sign`: keys here, and a key for a vehicle over a cable."""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from dialects.enums import Autopilot
from groundstation.verbs.common.exit_codes import ExitCode
from link.signing.key_file import load_keys, save_keys, station_key_file
from link.signing.keys import KeyRing, SigningKey, new_key
from link.signing.role import SigningRole
from tests.e2e.cable import SerialCable
from tests.e2e.programs import Vehicle
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.fakes.wires import PymavlinkWire
from tests.groundstation.verbs.verb_runs import run_until_answered, run_verb
from tests.waits import wait_until

pytestmark = pytest.mark.xdist_group("verbs that sign")
Capture = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def _folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("CONFIG", "STATE", "CACHE"):
        monkeypatch.setenv(f"XDG_{name}_HOME", str(tmp_path / name))


def key_of(name: str) -> SigningKey:
    key = load_keys(station_key_file()).find(name)
    assert key is not None
    return key


def test_keys_are_made_listed_chosen_and_forgotten(capsys: Capture) -> None:
    made = run_verb(capsys, "sign", "new", "rover")
    assert (made.code, made.out) == (0, "")
    assert key_of("rover").fingerprint in made.err
    assert key_of("rover").secret.hex() not in made.err
    run_verb(capsys, "sign", "new", "boat")
    run_verb(capsys, "sign", "use", "boat")
    prints = [key_of(name).fingerprint for name in ("rover", "boat")]
    assert (
        run_verb(capsys, "sign", "list").out
        == f"  rover                     {prints[0]}\n> boat                      {prints[1]}\n"
    )
    listed = run_verb(capsys, "sign", "list", "--json").records
    assert listed[1] == {"name": "boat", "fingerprint": prints[1], "signs": True}
    assert f"mavhelm vehicle key revoke {prints[0]}" in run_verb(capsys, "sign", "forget", "rover").err
    assert [key.name for key in load_keys(station_key_file()).keys] == ["boat"]


def test_the_secret_is_shown_on_request_only(capsys: Capture) -> None:
    run_verb(capsys, "sign", "new", "rover")
    key = key_of("rover")
    assert run_verb(capsys, "sign", "show").out == f"rover  {key.fingerprint}\n"
    shown = run_verb(capsys, "sign", "show", "rover", "--hex")
    assert shown.out == f"{key.secret.hex()}\n"
    assert shown.err.count("\n") == 1


def test_a_passphrase_is_entered_as_in_mavproxy(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"secret_key\n")))
    assert run_verb(capsys, "sign", "install", "copter", "--passphrase").code == 0
    assert key_of("copter").secret.hex().startswith("6523e58bc0eec42c")


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("install", "x"), "say what to enter"),
        (("install", "x", "--hex", "none.txt"), "none.txt: No such file"),
        (("show", "x"), "there are no keys"),
        (("new", "a b"), "a key's name is"),
        (("setup",), "serial or USB cable only"),
        (("setup", "-e", "udpin:127.0.0.1:14550"), "serial or USB cable only"),
        (("setup", "-e", "tcpout:127.0.0.1:5760"), "serial or USB cable only"),
        (("setup", "-e", "serial:/dev/ttyS99:57600", "--station", "only"), "does not go through a station"),
        (("setup", "-e", "serial:/dev/ttyS99:57600"), "there are no keys; `mavhelm sign new NAME` makes one"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line(capsys: Capture, words: tuple[str, ...], expected: str) -> None:
    run = run_verb(capsys, "sign", *words)
    assert run.code == ExitCode.USAGE
    assert expected in run.err
    assert run.err.count("\n") == 1


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[SerialCable]:
    cable = SerialCable(tmp_path)
    yield cable
    cable.close()


def assert_keys_are_added_by_a_holder_only(capsys: Capture, cable: SerialCable, state: Path) -> None:
    run_verb(capsys, "sign", "new", "second")
    rotated = run_until_answered(capsys, "sign", "setup", "second", "-e", cable.two)
    assert (rotated.code, len(load_keys(state / "keys.toml").keys)) == (ExitCode.DONE, 2), rotated.err
    mine = load_keys(station_key_file())
    save_keys(station_key_file(), KeyRing().add(new_key("stranger", SigningRole.SET_UP)))
    refused = run_until_answered(capsys, "sign", "setup", "--unsigned", "-e", cable.two)
    assert refused.code == ExitCode.REFUSED
    assert "refused: 'mavhelm vehicle key install'" in refused.err
    save_keys(station_key_file(), mine)


def command_lines() -> Iterator[bytes]:
    """The command line of every process of this computer; some end meanwhile."""
    for pid in filter(str.isdigit, os.listdir("/proc")):
        with contextlib.suppress(OSError):
            yield Path(f"/proc/{pid}/cmdline").read_bytes()


def artefacts(folder: Path) -> Iterator[Path]:
    """Every file of the session but the key files."""
    return (path for path in folder.rglob("*") if path.is_file() and path.name != "keys.toml")


def test_a_vehicle_gets_its_first_key_over_a_cable_and_alone(
    capsys: Capture, tmp_path: Path, cable: SerialCable
) -> None:
    state = tmp_path / "state"
    vehicle = Vehicle(
        tmp_path, cable.one, "--state", str(state), "--param", "LOG_DISARMED=1", "--log-file", str(tmp_path / "log")
    )
    try:
        wait_until(lambda: "ready" in vehicle.errors.read_text(), "the vehicle does not start")
        run_verb(capsys, "sign", "new", "rover")
        key = key_of("rover")
        run = run_until_answered(capsys, "sign", "setup", "-e", cable.two)
        assert (run.code, run.out) == (0, "")
        assert f"has the key rover ({key.fingerprint})" in run.err
        stored = load_keys(state / "keys.toml").keys
        assert stored == (SigningKey(f"cable-{key.fingerprint}", SigningRole.SET_UP, key.secret),)
        assert_keys_are_added_by_a_holder_only(capsys, cable, state)
        params = run_verb(capsys, "param", "get", "-e", cable.two)
        doctor = run_verb(capsys, "doctor", "-e", cable.two, "--report", str(tmp_path / "report.txt"))
        run_verb(capsys, "record", str(tmp_path / "heard.tlog"), "--for", "1", "-e", cable.two)
        lines = b"".join(command_lines())
    finally:
        vehicle.end()
    texts = (run.err + params.out + params.err + doctor.out + doctor.err).encode() + lines
    found = {path.name: path.read_bytes() for path in artefacts(tmp_path)}
    assert any(name.endswith(".tlog") and content for name, content in found.items())
    assert {"log", "report.txt"} <= found.keys()
    for form in (
        key.secret,
        key.secret.hex().encode(),
        key.secret.hex().upper().encode(),
        str(list(key.secret)).encode(),
    ):
        assert form not in texts
        assert [name for name, content in found.items() if form in content] == []


@pytest.mark.parametrize(("listens", "code"), [(True, ExitCode.DONE), (False, ExitCode.NO_ANSWER)])
def test_an_ardupilot_gets_the_key_and_is_known_by_its_signature(
    capsys: Capture, tmp_path: Path, cable: SerialCable, listens: bool, code: ExitCode, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("groundstation.verbs.setup.sign_setup.TRIES", 2)
    run_verb(capsys, "sign", "new", "copter")
    wire = PymavlinkWire(listens=listens)
    with on_line(FakeVehicle(autopilot=Autopilot.ARDUPILOT), endpoint=str(tmp_path / "tty-one"), wire=wire):
        run = run_verb(capsys, "sign", "setup", "-e", cable.two)
    assert run.code == code
    assert wire.key == (key_of("copter").secret if listens else None)
    assert ("has the key" if listens else "has not answered") in run.err


def test_an_ardupilot_whose_key_is_lost_gets_another_one(capsys: Capture, tmp_path: Path, cable: SerialCable) -> None:
    run_verb(capsys, "sign", "new", "copter")
    wire = PymavlinkWire(key=bytes(range(1, 33)), listens=True)
    with on_line(FakeVehicle(autopilot=Autopilot.ARDUPILOT), endpoint=str(tmp_path / "tty-one"), wire=wire):
        unheard = run_verb(capsys, "sign", "setup", "-e", cable.two, "--wait", "1")
        run = run_verb(capsys, "sign", "setup", "--unsigned", "-e", cable.two)
    assert unheard.code == ExitCode.NO_VEHICLE
    assert run.code == ExitCode.DONE
    assert wire.key == key_of("copter").secret
