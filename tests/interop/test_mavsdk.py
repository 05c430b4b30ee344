"""MAVSDK finds the vehicle, reads version and position, sets parameters, drives it, and reads its files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.interop import mavsdk_process, mavsdk_streams
from tests.interop.conftest import HOME, Rover
from tests.interop.mavsdk_process import Client
from vehicle.commands.reboot import RebootRequest
from vehicle.params import TABLE

pytestmark = [pytest.mark.interop, mavsdk_process.needed]

INSTANT = 0.5
"""s: the shortest of MAVSDK's own timeouts."""


@pytest.fixture
def client(rover: Rover, tmp_path: Path) -> Iterator[Callable[[str], Client]]:
    """Start a scenario and end the one before; return when MAVSDK has found the vehicle."""
    with ExitStack() as stack:

        def start(scenario: str) -> Client:
            stack.close()
            client = Client(rover.port, scenario, tmp_path)
            stack.callback(client.end)
            client.discovery = client.good("discover").took
            return client

        yield start


def test_what_it_is_and_where(client: Callable[[str], Client], rover: Rover) -> None:
    rover.speaks()
    sdk = next(each for each in map(client, ["identity"] * 3) if each.discovery < 1.5 + each.waits.total())
    sdk.good("version")
    for stream in mavsdk_streams.ASKED:
        sdk.good(f"rate of {stream}")
    for stream in mavsdk_streams.UNASKED | mavsdk_streams.ASKED:
        sdk.good(stream)
    sdk.good("faster")
    assert sdk.good("20 at 20 Hz").took < 4.0 + sdk.waits.total()  # 5 s at the usual 4 Hz


def test_parameters(client: Callable[[str], Client]) -> None:
    sdk = client("parameters")
    assert sdk.good("all").value == len(TABLE)
    assert sdk.good("get").value == pytest.approx(1.5)
    sdk.good("set")
    assert sdk.good("get again").value == pytest.approx(1.4)
    for refused in ("unknown", "set unknown", "out of range"):
        step = sdk.step(refused)
        assert step.error is not None
        assert step.took < INSTANT + sdk.waits.total()


def test_it_drives_by_hand(client: Callable[[str], Client], rover: Rover) -> None:
    sdk = client("driving")
    sdk.good("arm")
    rover.drives()
    sdk.say()
    sdk.good("hold")
    rover.stands()
    sdk.good("disarm")


@pytest.mark.parametrize("options", [("--param", "REBOOT_ENABLE=2")])
@pytest.mark.parametrize(("word", "code"), [("reboot", RebootRequest.RESTART), ("shutdown", RebootRequest.POWER_OFF)])
def test_it_starts_again_and_is_turned_off(
    client: Callable[[str], Client], rover: Rover, word: str, code: RebootRequest, options: tuple[str, ...]
) -> None:
    sdk = client("leaving")
    sdk.say(word)
    sdk.good(word)
    assert rover.vehicle.process.wait(60) == code


def test_home_and_the_origin_are_where_they_are_set(client: Callable[[str], Client]) -> None:
    sdk = client("places")
    for done in ("home", "home told", "origin"):
        sdk.good(done)
    assert sdk.good("origin told").value == pytest.approx(500.0)


@pytest.mark.slow
def test_it_drives_by_itself(client: Callable[[str], Client], rover: Rover) -> None:
    sdk = client("guided")
    sdk.good("speed")
    sdk.good("goto")
    rover.drives()
    rover.stands()
    sdk.say()
    assert sdk.good("gone").value == pytest.approx(110, abs=60)  # 1.2 m, within 0.7 m
    assert 0.3 < float(str(sdk.good("fastest").value)) < 0.7  # usually 0.8
    sdk.good("return")
    rover.drives()
    sdk.say()
    sdk.good("hold")
    rover.stands()
    sdk.say()
    sdk.good("offboard")
    rover.drives()
    sdk.say()
    sdk.good("stop")
    rover.stands()
    sdk.good("disarm")


@pytest.mark.slow
def test_a_mission_from_upload_to_its_end(client: Callable[[str], Client], rover: Rover) -> None:
    sdk = client("mission")
    sdk.good("upload")
    assert sdk.good("download").value is True
    assert "UNSUPPORTED" in str(sdk.step("refused").error)
    sdk.good("fence")
    assert sdk.good("fence back").value == 3
    sdk.good("arm")
    sdk.good("start")
    rover.drives()
    sdk.good("progress")
    assert sdk.good("finished").value is True
    rover.is_at((HOME[0] + 0.00004, HOME[1]))
    sdk.good("disarm")
    sdk.good("clear")
    assert sdk.good("empty").value == 0


@pytest.mark.slow
def test_a_mission_as_its_examples_make_it(client: Callable[[str], Client], rover: Rover) -> None:
    sdk = client("plan")
    sdk.good("refused")
    sdk.good("upload")
    assert sdk.good("download").value == 2
    sdk.good("arm")
    sdk.good("start")
    sdk.good("progress")
    assert sdk.good("finished").value is True
    rover.stands()
    rover.is_at((HOME[0] + 0.00004, HOME[1]))


def test_files_logs_and_what_the_parameters_mean(client: Callable[[str], Client]) -> None:
    sdk = client("files")
    assert "parameter.json.xz" in str(sdk.good("root").value)
    for path in ("/parameter.json.xz", "@PARAM/param.pck"):
        assert "SUCCESS" in str(sdk.good(path).value)
    assert sdk.good("same").value is True
    assert "DOES_NOT_EXIST" in str(sdk.step("no file").value)
    assert sdk.step("write").error is not None
    sdk.step("logs")
    assert sdk.good("metadata").value is True
    assert "SPEED_MAX" in str(sdk.good("meaning").value)
