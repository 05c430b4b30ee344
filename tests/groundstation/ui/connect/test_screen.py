"""The Connect screen: what ENTER opens, questions, endpoints used before; and closing links on the Links screen."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.links import AddLink, CloseLink
from groundstation.intents.session import StartSimulator
from groundstation.intents.vehicle import SelectVehicle
from groundstation.intents.watch import Watch
from groundstation.recent.recent_file import RecentFile
from groundstation.snapshot import Snapshot
from groundstation.ui.connect.screen import ConnectScreen
from groundstation.views.connect import ConnectRequest, ConnectView, HeardRow, LinkAttempt
from tests.groundstation.ui.example_connect import (
    CONNECT,
    FAILED,
    NOTHING,
    UNCONNECTED,
    forget,
    remember,
)
from tests.groundstation.ui.example_files import fill_folder
from tests.groundstation.ui.files.test_log_summary import HEARTBEATS, log
from tests.groundstation.ui.link_examples import FLEET, VIEWS
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until


@pytest.fixture(autouse=True)
def recent() -> Iterator[None]:
    remember(time.time())
    yield
    forget()


async def open_connect(screen: Console, view: ConnectView = CONNECT, picture: Snapshot = UNCONNECTED) -> None:
    await screen.press("ctrl+g", "c")
    await until(lambda: screen.station.of(Watch))
    assert screen.station.of(Watch)[-1] == Watch((ConnectRequest(),))
    await offer(screen, view, picture)


async def offer(screen: Console, view: ConnectView, picture: Snapshot = UNCONNECTED) -> None:
    screen.station.offer_view(view)
    await screen.show(picture)
    await screen.show(picture)


def attempt(add: AddLink, state: str, problem: str = "") -> LinkAttempt:
    return LinkAttempt(add.request, add.endpoint, state, problem)


async def test_only_enter_connects_and_to_the_marked_vehicle() -> None:
    async with console(picture=UNCONNECTED) as screen:
        await open_connect(screen)
        await screen.press("down", "tab", "tab", "tab", "tab", "p", "i", "w", "r")
        assert not [*screen.station.of(AddLink), *screen.station.of(StartSimulator)]
        await screen.press("enter")
        (add,) = screen.station.of(AddLink)
        assert (add.endpoint, add.watch_only) == ("udpin:127.0.0.1:14551", False)
        await offer(screen, msgspec.structs.replace(CONNECT, attempts=(attempt(add, "open"),)))
        assert isinstance(screen.app.screen, ConnectScreen), "the vehicle was not heard there yet"
        found = msgspec.structs.replace(FLEET, vehicles=(1, 3))
        await screen.show(found)
        await until(lambda: screen.app.screen is screen.app.drive)
        assert screen.station.of(SelectVehicle) == [SelectVehicle(system=3)]
    entry = RecentFile().load().entries[0]
    assert (entry.endpoint, entry.vehicle) == ("udpin:127.0.0.1:14551", "Rover 3")


async def test_enter_with_nothing_heard_starts_simulator_or_key_others() -> None:
    async with console(picture=UNCONNECTED) as screen:
        await open_connect(screen, NOTHING)
        await screen.press("enter")
        assert screen.station.of(StartSimulator) == [StartSimulator()]
        assert screen.app.screen is screen.app.drive
        await open_connect(screen, NOTHING)
        await screen.press("v")
        assert screen.station.of(StartSimulator)[-1] == StartSimulator(kind="three")
        assert not screen.station.of(DriveKeyDown)


async def test_watch_only() -> None:
    async with console(picture=UNCONNECTED) as screen:
        await open_connect(screen)
        await screen.press("W")
        assert screen.station.of(AddLink)[-1].watch_only
        await offer(screen, NOTHING)
        await screen.press("W", *"udpin:127.0.0.1:9", "enter")
        await until(lambda: len(screen.station.of(AddLink)) == 2)
        assert screen.station.of(AddLink)[-1] == AddLink(request=2, endpoint="udpin:127.0.0.1:9", watch_only=True)


async def test_a_typed_endpoint_is_checked_while_it_is_typed() -> None:
    async with console((140, 45), UNCONNECTED) as screen:
        await open_connect(screen)
        await screen.press("colon", *"udp:10.0.0.7:1")
        await until(lambda: "did you mean udpin:10.0.0.7:1?" in screen.text)
        await screen.press("enter")
        assert screen.station.of(AddLink) == []
        await screen.press("colon", *"tcpout:10.0.0.7:5762", "enter")
        await until(lambda: screen.station.of(AddLink))
        assert screen.station.of(AddLink)[-1].endpoint == "tcpout:10.0.0.7:5762"


async def test_the_whole_network_is_asked_for_once() -> None:
    endpoint = "udpin:0.0.0.0:14777"
    async with console((140, 45), UNCONNECTED) as screen:
        await open_connect(screen)
        await screen.press("colon", *endpoint, "enter")
        await until(lambda: "which everybody in the network can send to" in screen.text)
        await screen.press("n")
        assert screen.station.of(AddLink) == []
        await screen.press("colon", *endpoint, "enter")
        await until(lambda: "which everybody in the network can send to" in screen.text)
        await screen.press("y")
        assert [add.endpoint for add in screen.station.of(AddLink)] == [endpoint]
        await screen.press("colon", *endpoint, "enter")
        await until(lambda: len(screen.station.of(AddLink)) == 2)
        await screen.press("tab", "enter")  # the pinned one was agreed to when it was opened first
        assert screen.station.of(AddLink)[-1].endpoint == "udpin:0.0.0.0:14550"


async def test_what_cannot_be_opened_says_why_and_stays() -> None:
    async with console((140, 45), UNCONNECTED) as screen:
        await open_connect(screen)
        await screen.press("tab", "down", "enter")
        (add,) = screen.station.of(AddLink)
        failed = attempt(add, "failed", "host '10.0.0.7' is not known")
        await offer(screen, msgspec.structs.replace(CONNECT, attempts=(msgspec.structs.replace(failed, retry_in=3.0),)))
        assert "› host '10.0.0.7' is not known" in screen.text
        assert "next try in 3 s" in screen.text
        assert isinstance(screen.app.screen, ConnectScreen)


async def test_recent_endpoints_are_pinned_and_forgotten() -> None:
    async with console(picture=UNCONNECTED) as screen:
        await open_connect(screen)
        await screen.press("x", "tab", "down", "p")
        assert [each.endpoint for each in RecentFile().load().entries if each.pinned] == [
            "udpin:0.0.0.0:14550",
            "tcpout:10.0.0.7:5760",
        ]
        await screen.press("x")
        assert RecentFile().load().find("tcpout:10.0.0.7:5760") is None


async def test_a_serial_port_opens_at_the_chosen_baud_rate_and_drives() -> None:
    async with console(picture=UNCONNECTED) as screen:
        await open_connect(screen, FAILED)
        await screen.press("tab", "tab", "b", "enter")
        assert screen.station.of(AddLink)[-1].endpoint == "serial:/dev/ttyACM0:115200"
        await screen.press("b", "b", "b", "b", "end", "enter")
        assert len(screen.station.of(AddLink)) == 1
        assert screen.app.screen is screen.app.drive


async def test_a_link_is_closed_after_a_question() -> None:
    async with console(picture=FLEET) as screen:
        await screen.press("f7")
        for view in VIEWS:
            screen.station.offer_view(view)
        await screen.show(FLEET)
        await screen.press("x")
        assert "TAB to the links first" in screen.text
        await screen.press("tab", "x")
        assert "close udpin:0.0.0.0:14550; what is driven over it gets neutral f… · y does it" in screen.text
        await screen.press("n", "x", "y")
        assert screen.station.of(CloseLink) == [CloseLink(link=0)]
        await screen.press("a")
        assert isinstance(screen.app.screen, ConnectScreen)


async def test_a_log_that_is_here_leads_to_the_files_screen(tmp_path: Path) -> None:
    async with console((140, 45), UNCONNECTED, folder=fill_folder(tmp_path)) as screen:
        await open_connect(screen)
        await screen.press("shift+tab", "down")
        assert "ENTER shows 2-00003.bin on the Files screen" in screen.text
        await screen.press("enter")
        assert any(line.startswith("│› 2-00003.bin") for line in screen.text.splitlines())


async def test_logs_here_tell_how_long_they_are(tmp_path: Path) -> None:
    (tmp_path / "a.tlog").write_bytes(log(HEARTBEATS, 754.0, 100))
    async with console((140, 45), UNCONNECTED, folder=tmp_path) as screen:
        await open_connect(screen)
        await until(lambda: "12:34" in screen.text)
        assert "length" in screen.text


async def test_arrows_skip_the_logs_where_there_is_no_room(tmp_path: Path) -> None:
    async with console((80, 24), UNCONNECTED, folder=fill_folder(tmp_path)) as screen:
        await open_connect(screen)
        await screen.press("shift+tab")
        assert "ENTER starts a simulator" in screen.text


async def test_d_asks_network_and_enter_connects_to_an_announcement() -> None:
    announced = HeardRow(
        endpoint="udpout:10.0.0.7:14550",
        system=7,
        name="Rover 7 on pi",
        mode="",
        armed=False,
        silence=0.0,
        announced=True,
    )
    async with console(picture=UNCONNECTED) as screen:
        await open_connect(screen, NOTHING)
        await screen.press("d")
        await until(lambda: screen.station.of(Watch)[-1] == Watch((ConnectRequest(search=True),)))
        await offer(screen, msgspec.structs.replace(NOTHING, heard=(announced,), searching=True))
        assert "Rover 7 on pi" in screen.text
        assert "searching the network" in screen.text
        await screen.press("enter")
        assert [each.endpoint for each in screen.station.of(AddLink)] == ["udpout:10.0.0.7:14550"]
        await offer(
            screen, msgspec.structs.replace(NOTHING, searching=True, search_problem="discovery needs the extra")
        )
        assert "discovery needs the extra" in screen.text
        await screen.press("d")
        await until(lambda: screen.station.of(Watch)[-1] == Watch((ConnectRequest(),)))
