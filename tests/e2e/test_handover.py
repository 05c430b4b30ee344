"""Control handed over between two real station processes, by a real vehicle."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.intents.session import Quit, ReportKeyReleases
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import GiveControl, KeepControl, ReleaseControl, RequestControl
from groundstation.snapshot import Snapshot
from tests.e2e.programs import Vehicle
from tests.groundstation.screen import Screen
from tests.ports import free_port
from tests.waits import wait_until

pytestmark = pytest.mark.e2e


class Pair:
    """Two stations on one rover; `driver` (255) drives it."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        port = free_port()
        # With 1.5 s a late machine is a failsafe; how a handover at the default goes is tested in virtual time.
        self.vehicle = Vehicle(folder, f"udpin:127.0.0.1:{port}", "--param", "FS_TIMEOUT=10")
        stack.callback(self.vehicle.end)
        endpoint = f"udpout:127.0.0.1:{port}"
        self.driver = stack.enter_context(Screen(endpoint, system=255))
        self.other = stack.enter_context(Screen(endpoint, system=254))
        self.other.see(lambda seen: seen.vehicle is not None and seen.vehicle.driver is not None)
        self.driver.hold_forward()
        self.driver.turn_wheels(self.vehicle.turning)
        self.other.see(lambda seen: seen.vehicle is not None and seen.vehicle.driver == 255)
        self.other.client.send(RequestControl())
        self.driver.see(lambda seen: seen.handover is not None and seen.handover.station == 254)
        self.other.see(lambda seen: seen.vehicle is not None and seen.vehicle.control_wait is not None)

    def answer(self, intent: AnyIntent) -> None:
        self.driver.client.send(intent)


@pytest.fixture
def pair(tmp_path: Path) -> Iterator[Pair]:
    with ExitStack() as stack:
        yield Pair(tmp_path, stack)


def in_manual(screen: Screen) -> bool:
    vehicle = screen.snapshot.vehicle
    return vehicle is not None and vehicle.armed and vehicle.mode == "MANUAL" and not vehicle.failsafes


def drives(screen: Screen) -> Snapshot:
    return screen.see(lambda seen: seen.vehicle is not None and seen.vehicle.in_control)


@pytest.mark.parametrize("intent", [GiveControl(), ReleaseControl(), Quit()], ids=["give", "release", "quit"])
def test_given_control_stops_the_rover_and_the_other_drives(pair: Pair, intent: AnyIntent) -> None:
    """Wheels turn, control is handed over, wheels are neutral, and the mode stays; nothing says failsafe."""
    pair.answer(intent)
    drives(pair.other)
    wait_until(pair.vehicle.stands)
    assert in_manual(pair.other)
    if not isinstance(intent, Quit):
        pair.driver.see(lambda seen: seen.vehicle is not None and seen.vehicle.driver == 254)
        assert pair.driver.snapshot.handover is None
    pair.other.client.send(ReportKeyReleases())
    pair.other.turn_wheels(pair.vehicle.turning)
    assert in_manual(pair.other)
    texts = [line.text for screen in (pair.driver, pair.other) for line in screen.snapshot.texts]
    assert any("in control" in text for text in texts)
    assert [text for text in texts if "ailsafe" in text or "HOLD" in text] == []


def test_kept_control_drives_on(pair: Pair) -> None:
    pair.answer(KeepControl())
    pair.driver.see(lambda seen: seen.handover is None)
    pair.driver.turn_wheels(pair.vehicle.turning)  # a control cycle that the machine delays is one without power
    assert drives(pair.driver).vehicle is not None
