"""A vehicle that announces itself is found, connected to, and gone when it ends: real processes, real multicast."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable

import pytest

from groundstation.intents.links import AddLink
from groundstation.intents.watch import Watch
from groundstation.views.connect import ConnectRequest, ConnectView, HeardRow
from tests.groundstation.screen import Screen
from tests.ports import free_port
from tests.waits import PATIENCE

pytestmark = pytest.mark.e2e
pytest.importorskip("zeroconf", reason="the extra [discovery] is not installed")

SYSTEM = 77


def find(screen: Screen, wanted: Callable[[list[HeardRow]], object]) -> list[HeardRow]:
    """Search until what is announced with our system id is as wanted; return it."""
    screen.client.send(Watch((ConnectRequest(search=True),)))
    for _ in range(600):
        screen.see(lambda seen: True)
        for view in screen.client.pop_views():
            if isinstance(view, ConnectView):
                assert view.searching
                assert not view.search_problem
                found = [row for row in view.heard if row.announced and row.system == SYSTEM]
                if wanted(found):
                    return found
    raise AssertionError("it was not found")


def test_an_announced_vehicle_is_found_and_connected_to() -> None:
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    vehicle = subprocess.Popen(
        [sys.executable, "-m", "vehicle", "--sim", "--announce", "--system", str(SYSTEM), endpoint]
    )
    try:
        with Screen() as screen:
            (row,) = find(screen, lambda rows: rows)
            assert row.endpoint == endpoint.replace("udpin", "udpout")
            assert row.name.startswith(f"Rover {SYSTEM} on ")
            assert not screen.snapshot.vehicles, "nothing is sent before the user chooses, so nothing answers"
            screen.client.send(AddLink(request=1, endpoint=row.endpoint))
            screen.see(lambda seen: seen.vehicles == (SYSTEM,))
            find(screen, lambda rows: not rows)
        with Screen() as screen:
            find(screen, lambda rows: rows)
            vehicle.send_signal(signal.SIGTERM)
            find(screen, lambda rows: not rows)
            assert vehicle.wait(PATIENCE) == 0
    finally:
        vehicle.kill()
        vehicle.wait()
