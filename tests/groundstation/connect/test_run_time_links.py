"""Links that are opened and closed while the station runs, for real: sockets, processes, a driver who holds a key."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from itertools import count, pairwise

import pytest

from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.links import AddLink, CloseLink
from groundstation.intents.session import StartSimulator
from groundstation.intents.vehicle import Disarm
from groundstation.intents.watch import Watch
from groundstation.station.driving.commander import STOP_TIMEOUT
from groundstation.views.connect import ConnectRequest, ConnectView, LinkAttempt
from groundstation.views.links import LinksRequest, LinksView
from tests.fakes.lines import on_line
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.screen import Screen
from tests.ports import free_port
from tests.waits import Waits, wait_until

pytestmark = pytest.mark.e2e

NUMBERS = count(1)
LONGEST_GAP = 0.12
"""s between two demands of a driver who holds a key: 0.05 s and a late tick or two."""


def endpoint() -> str:
    return f"udpin:127.0.0.1:{free_port()}"


def connect_view(screen: Screen, wanted: Callable[[ConnectView], object]) -> ConnectView:
    """Watch until a view is as wanted."""
    screen.client.send(Watch((ConnectRequest(), LinksRequest())))
    for _ in range(300):
        screen.see(lambda seen: True)
        for view in screen.client.pop_views():
            if isinstance(view, ConnectView) and wanted(view):
                return view
    raise AssertionError("no such view")


def add(screen: Screen, text: str, wanted: str, *, watch_only: bool = False) -> LinkAttempt:
    """Add a link; return the attempt when its state is as wanted."""
    number = next(NUMBERS)
    screen.client.send(AddLink(request=number, endpoint=text, watch_only=watch_only))

    def states(view: ConnectView) -> list[LinkAttempt]:
        return [each for each in view.attempts if each.request == number and each.state == wanted]

    return states(connect_view(screen, states))[0]


def index_of(screen: Screen, name: str) -> int:
    screen.client.send(Watch((LinksRequest(),)))
    for _ in range(300):
        screen.see(lambda seen: True)
        for view in screen.client.pop_views():
            for row in view.rows if isinstance(view, LinksView) else ():
                if row.name == name:
                    return row.index
    raise AssertionError(f"no link {name}")


def test_a_driver_notices_nothing_of_a_link_added_and_closed() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        waits, begun = Waits(screen.client.pid), time.monotonic()
        other = endpoint()
        assert add(screen, other, "open").problem == ""
        with on_line(FakeVehicle(system=2), endpoint=other):
            screen.see(lambda seen: seen.vehicles == (1, 2))
            screen.client.send(CloseLink(link=index_of(screen, other)))
            screen.see(lambda seen: seen.vehicles == (1,) and other not in seen.endpoints)
            closed = time.monotonic()
        wait_until(lambda: len(vehicle.demands(closed)) > 10)
        demands = [at for at, x in vehicle.demands(begun) if x == 600]
        assert demands[-1] > closed
        gaps = [later - before for before, later in pairwise(demands)]
        assert max(gaps) < LONGEST_GAP + waits.total()
        assert not [x for _, x in vehicle.demands(begun) if not x]


def test_closing_a_link_is_neutral_first_and_then_silence() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        begun = time.monotonic()
        assert any(x == 600 for _, x in vehicle.demands(begun - 1.0))
        screen.client.send(CloseLink(link=0))
        screen.see(lambda seen: seen.endpoints == ())
        closed = time.monotonic()
        wait_until(lambda: len([x for _, x in vehicle.demands(begun) if not x]) >= 5)
        neutral = [at for at, x in vehicle.demands(begun) if not x]
        assert len(neutral) == 5
        assert not [at for at, x in vehicle.demands(neutral[0]) if x]
        screen.client.send(DriveKeyDown(key="i", throttle=1, steering=0))
        number = screen.snapshot.number
        screen.see(lambda seen: seen.number > number + 5)
        assert not [each for at, each in vehicle.received if at > closed + 0.3]
        assert screen.snapshot.left_armed, "it is armed, and stays on the list"


def test_a_disarmed_vehicle_is_forgotten_with_its_link() -> None:
    with Screen() as screen, on_line(FakeVehicle(), endpoint=screen.endpoint) as vehicle:
        screen.drive(vehicle)
        screen.client.send(Disarm())
        screen.see(lambda seen: seen.vehicle is not None and not seen.vehicle.armed)
        screen.client.send(CloseLink(link=0))
        shown = screen.see(lambda seen: seen.vehicle is None)
        assert shown.waiting == "no link yet: Connect opens one"
        assert shown.left_armed == ()


def test_a_link_that_only_watches_never_sends_a_byte() -> None:
    with Screen() as screen:
        watched = endpoint()
        add(screen, watched, "open", watch_only=True)
        with on_line(FakeVehicle(), endpoint=watched) as vehicle:
            screen.see(lambda seen: seen.vehicle is not None and seen.vehicle.alive)
            screen.insist(
                lambda: screen.client.send(Disarm()),
                lambda seen: any("no answer" in line.text for line in seen.texts),
                within=2 * STOP_TIMEOUT,
            )
            assert vehicle.received == []
            assert [link.watch_only for link in screen.snapshot.links] == [False, True]


def test_a_port_of_another_program_is_retried_until_it_is_free() -> None:
    with Screen() as screen, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        port = free_port()
        other.bind(("127.0.0.1", port))
        attempt = add(screen, f"udpin:127.0.0.1:{port}", "failed")
        assert "is in use" in attempt.problem
        assert attempt.retry_in is not None
        screen.see(lambda seen: any(link.problem and "is in use" in link.problem for link in seen.links))
        other.close()
        connect_view(screen, lambda view: f"udpin:127.0.0.1:{port}" in view.endpoints)
        screen.see(lambda seen: len(seen.links) == 2 and not any(link.problem for link in seen.links))


def test_what_cannot_be_opened_is_refused_with_the_reason() -> None:
    with Screen() as screen:
        first = screen.endpoint
        assert "it must be one of" in add(screen, "carrier pigeon", "refused").problem
        assert "given twice" in add(screen, first, "refused").problem
        quiet = add(screen, "udpout:127.0.0.1:14999", "refused", watch_only=True)
        assert "sends nothing before it is sent to" in quiet.problem
        unknown = add(screen, "tcpout:no-such-host.invalid:5760", "failed")
        assert "is not known" in unknown.problem
        assert screen.snapshot.endpoints[0] == first


def test_a_station_without_a_link_starts_a_simulator_on_its_own() -> None:
    with Screen(none=True) as screen:
        screen.see(lambda seen: seen.endpoints == () and seen.waiting is not None)
        screen.client.send(StartSimulator(kind="three"))
        screen.see(lambda seen: seen.vehicles == (1, 2, 3))
