"""The Links screen: choosing a vehicle, panels, keys of the action table."""

from __future__ import annotations

from functools import partial

import msgspec
import pytest

from groundstation.actions import ACTIONS, OperatorAction
from groundstation.intents.base import Intent
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.vehicle import (
    Arm,
    Disarm,
    GiveControl,
    KeepControl,
    ReleaseControl,
    RequestControl,
    SelectNextVehicle,
    SelectVehicle,
    SetMode,
)
from groundstation.intents.watch import Watch
from groundstation.snapshot import HandoverNotice, Snapshot
from groundstation.ui.keys.key_gate import OTHER_SCREEN
from groundstation.ui.links.link_table import LinkTable, LinkTableValue
from groundstation.ui.links.screen import LinksScreen
from groundstation.views.base import View
from groundstation.views.links import (
    ControlRequest,
    ControlView,
    LinkRow,
    LinksRequest,
    LinksView,
    PathRow,
    VehiclesRequest,
)
from tests.groundstation.ui.examples import DRIVE_WATCH, snapshot, vehicle
from tests.groundstation.ui.link_examples import CONTROL, FLEET, LINKS, OURS, SIX, VIEWS, fleet, many
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

STOPS: dict[str, set[type[Intent]]] = {
    "drive.stop": {Stop}, "stop.emergency": {EmergencyStop, Stop}, "agent.decline": {Stop},
}  # fmt: skip
"""Action -> which stops its keys send while the vehicle is driven."""

VEHICLE_INTENTS = (Arm, Disarm, SetMode, RequestControl, ReleaseControl, SelectVehicle, SelectNextVehicle)


async def open_links(screen: Console, picture: Snapshot = FLEET, views: tuple[View, ...] = VIEWS) -> LinksScreen:
    await screen.press("f7")
    await until(lambda: LinksRequest() in screen.station.of(Watch)[-1].requests)
    await offer(screen, picture, *views)
    top = screen.app.screen
    assert isinstance(top, LinksScreen)
    return top


async def offer(screen: Console, picture: Snapshot, *views: View) -> None:
    for view in views:
        screen.station.offer_view(view)
    await screen.show(picture)


def row_of(screen: Console, name: str) -> str:
    return next(line for line in screen.text.splitlines() if line.startswith("│") and f" {name} " in line)


def cursor_is_on(screen: Console, name: str) -> bool:
    return any(line.startswith("│›") and f" {name} " in line for line in screen.text.splitlines())


# ---- views ----


async def test_it_requests_its_views_only_while_it_is_open() -> None:
    async with console() as screen:
        await open_links(screen)
        assert screen.station.of(Watch)[-1] == Watch((VehiclesRequest(), LinksRequest(), ControlRequest()))
        await screen.press("escape")
        await until(lambda: screen.station.of(Watch)[-1] == DRIVE_WATCH)


async def test_until_the_views_arrive_it_waits_for_the_station() -> None:
    async with console() as screen:
        await screen.press("f7")
        await until(lambda: screen.text.count("waiting for the station") == 3)
        await offer(screen, FLEET, *VIEWS)
        await until(lambda: "waiting for the station" not in screen.text)


# ---- choosing ----


async def test_enter_chooses_the_vehicle_under_the_cursor() -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        assert row_of(screen, "Rover 1").startswith("│›●")
        await screen.press("down", "down")
        await until(lambda: row_of(screen, "Rover 3").startswith("│› "))
        await until(lambda: "ENTER chooses Rover 3; Rover 1 gets neutral first" in screen.text)
        assert not screen.station.of(SelectVehicle)
        await screen.press("enter")
        assert screen.station.of(SelectVehicle) == [SelectVehicle(system=3)]
        await screen.show(msgspec.structs.replace(FLEET, vehicle=vehicle(system=3, name="Rover 3")))
        await until(lambda: row_of(screen, "Rover 3").startswith("│›●"))
        assert row_of(screen, "Rover 1").startswith("│  ")
        await until(lambda: "F1 drives Rover 3" in screen.text)


async def test_enter_on_the_selected_vehicle_sends_nothing() -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        await screen.press("down", "up", "enter")
        assert not screen.station.of(SelectVehicle)


@pytest.mark.parametrize(
    ("keys", "system"),
    [
        (("7",), 7), (("5",), 1), (("1", "6"), 16), (("1", "9"), 1), (("end",), 16), (("end", "home", "down"), 2),
        (("pagedown",), 6), (("up",), 1),
    ],
)  # fmt: skip
async def test_digits_are_a_system_id_and_keys_move(keys: tuple[str, ...], system: int) -> None:
    views = (many(4) if keys == ("5",) else many(16, 4), LINKS, CONTROL)
    async with console(picture=fleet(20)) as screen:
        await open_links(screen, fleet(20), views)
        await screen.press(*keys)
        await until(lambda: row_of(screen, f"Rover {system}").startswith("│›"))


async def test_more_vehicles_than_rows_keep_cursor_visible_and_a_count() -> None:
    async with console(picture=fleet(20)) as screen:
        await open_links(screen, fleet(20), (many(16, 4), LINKS, CONTROL))
        assert "16 of 20 heard" in screen.text
        assert "4 more heard, not shown" in screen.text
        assert "Rover 16" not in screen.text
        for system in range(2, 17):
            await screen.press("down")
            await until(partial(cursor_is_on, screen, f"Rover {system}"))


async def test_vanished_vehicle_leaves_the_cursor_on_the_selected_one() -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        await screen.press("end")
        await until(lambda: row_of(screen, "Rover 9").startswith("│›"))
        await offer(screen, FLEET, many(2))
        await until(lambda: row_of(screen, "Rover 1").startswith("│›●"))


async def test_details_of_the_vehicle_under_the_cursor() -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        assert "firmware 0.1.0 · active · in control: this one · signing on · 100 camera" in screen.text
        await screen.press("2")
        await until(lambda: "2 firmware 4.6.1 · critical · in control: not told" in screen.text)


async def test_a_name_from_the_link_brings_no_control_characters() -> None:
    async with console(picture=FLEET) as screen:
        bad = msgspec.structs.replace(SIX.rows[0], name="Rover\x1b[2J1", mode="A\nB")
        await open_links(screen, views=(msgspec.structs.replace(SIX, rows=(bad,)), LINKS, CONTROL))
        await until(lambda: "Rover�[2J1" in screen.text and "A�B" in screen.text)


# ---- panels ----


async def test_tab_gives_each_panel_the_room_in_turn() -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        assert "/dev/ttyACM0 has gone" not in screen.text
        assert "4 links, 1 with a problem: serial:/dev/ttyACM0:115200" in screen.text
        await screen.press("tab")
        await until(lambda: "/dev/ttyACM0 has gone; it is opened again when it is plugged in" in screen.text)
        assert "68% of 5.8 kB/s each way, the radio allows 80%" in screen.text
        assert "↑ ↓ scrolls" in screen.text
        await screen.press("tab")
        await until(lambda: "also heard  250/190 0.6 s ago · 245/191 0.2 s ago" in screen.text)
        await screen.press("tab")
        await until(lambda: "Rover 9" in screen.text)


async def test_enter_chooses_nothing_while_another_panel_has_arrows() -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        await screen.press("down", "tab", "enter")
        assert not screen.station.of(SelectVehicle)


async def test_links_with_a_problem_are_named_as_far_as_there_is_room() -> None:
    broken = tuple(LinkRow(name=f"udpin:0.0.0.0:{14550 + each}", index=each, problem="cut") for each in range(12))
    async with console(picture=FLEET) as screen:
        await open_links(screen, views=(SIX, LinksView(broken), CONTROL))
        assert "12 links, 12 with a problem: udpin:0.0.0.0:14550, udpin:0.0.0.0:" in screen.text
        assert all(len(line) <= 80 for line in screen.text.splitlines())


async def test_many_links_scroll() -> None:
    links = LinksView(tuple(LinkRow(name=f"udpin:0.0.0.0:{14550 + number}", index=number) for number in range(12)))
    async with console(picture=FLEET) as screen:
        await open_links(screen, views=(SIX, links, CONTROL))
        await screen.press("tab", "end")
        await until(lambda: "0.0.0.0:14561" in screen.text and "0.0.0.0:14550" not in screen.text)
        await screen.press("home")
        await until(lambda: "0.0.0.0:14550" in screen.text and "0.0.0.0:14561" not in screen.text)


@pytest.mark.parametrize("size", [(40, 10), (60, 15), (79, 23), (120, 30), (200, 60)])
async def test_every_size_shows_vehicles_armed_or_not(size: tuple[int, int]) -> None:
    async with console(size, FLEET) as screen:
        await open_links(screen)
        for number in range(4):
            lines = screen.text.splitlines()
            assert len(lines) <= size[1]
            assert max(map(len, lines)) <= size[0]
            if number in (0, 3):
                assert "Rover 1" in screen.text
                assert size[0] == 40 or "ARMED" in row_of(screen, "Rover 1")
            await screen.press("tab")


# ---- control ----


async def test_without_a_vehicle_it_says_what_the_station_waits_for() -> None:
    picture = snapshot(vehicle=None, waiting="waiting for a vehicle on udpin:127.0.0.1:14550")
    views = (many(0), LinksView((LinkRow(name="udpin:127.0.0.1:14550"),)), ControlView(vehicle="", ours=OURS))
    async with console((140, 45), picture) as screen:
        await open_links(screen, picture, views)
        assert "waiting for a vehicle on udpin:127.0.0.1:14550" in screen.text
        assert "nobody yet" in screen.text
        assert "no vehicle yet" in screen.text
        await screen.press("down", "enter", "7", "tab", "down", "tab", "up")
        assert not screen.station.of(SelectVehicle)


# ---- keys ----


@pytest.mark.parametrize(
    ("key", "intent"),
    [
        ("n", SelectNextVehicle()), ("g", RequestControl()), ("G", ReleaseControl()), ("Y", GiveControl()),
        ("N", KeepControl()),
    ],
)  # fmt: skip
async def test_the_keys_of_control_work_here(key: str, intent: Intent) -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        await screen.press(key)
        assert screen.station.of(type(intent)) == [intent]


async def test_a_request_of_another_station_stands_in_sight() -> None:
    picture = msgspec.structs.replace(FLEET, handover=HandoverNotice(250, "Rover 1", 7.0))
    async with console(picture=picture) as screen:
        await open_links(screen, picture)
        await until(lambda: "GCS 250 requests control of Rover 1: Y gives, N keeps (7 s)" in screen.text)


HERE = [action for action in ACTIONS.values() if action.group != "app"]  # the others open screens, or quit


async def test_only_stops_and_control_actions_reach_the_station() -> None:
    """Keys that drive reach it while its gate is closed: it must know that they are held."""
    async with console(picture=FLEET) as screen:
        for action in HERE:
            for key in screen.app.gate.keymap.get_keys(action.id):
                if not screen.is_clean(LinksScreen):
                    await screen.go_home()
                    await open_links(screen)
                await assert_allowed(screen, action, key)


async def assert_allowed(screen: Console, action: OperatorAction, key: str) -> None:
    """Press a key of an action on this screen; check what reaches the station."""
    assert (shut := screen.app.gate.closure) is not None
    assert shut.reason == OTHER_SCREEN.reason, action.id
    assert screen.station.of(SetKeyGate)[-1].open is False, action.id
    before = len(screen.station.intents)
    await screen.press(key)
    sent = [type(each) for each in screen.station.intents[before:] if isinstance(each, VEHICLE_INTENTS)]
    allowed = action.id in ("vehicle.next", "vehicle.control", "vehicle.release")
    assert len(sent) == int(allowed), (action.id, key)
    assert screen.station.of(SetKeyGate)[-1].open is False, (action.id, key)
    stops = {type(each) for each in screen.station.intents[before:]} & {Stop, EmergencyStop}
    assert stops == STOPS.get(action.id, set()), (action.id, key)


async def test_drive_keys_move_the_cursor_and_drive_nothing() -> None:
    async with console(picture=FLEET) as screen:
        await open_links(screen)
        await screen.press("i", "down")
        assert screen.station.of(DriveKeyDown)
        assert screen.station.of(SetKeyGate)[-1].open is False
        await until(lambda: row_of(screen, "ArduPilot rover 2").startswith("│›"))


def test_further_addresses_of_a_vehicle_are_named_below_its_link() -> None:
    more = (PathRow(address="10.0.0.9:5", round_trip=0.031, age=75.0),)
    table = LinkTable(
        LinkTableValue(LinksView((LinkRow(name="udpin:0.0.0.0:14550", age=0.1, counts=True, more=more),)))
    )
    lines = [line.text for line in table.draw(100, 9)]
    assert lines[2].strip() == "also from 10.0.0.9:5: round trip 31 ms, age 1:15"
    assert "★" not in lines[1]  # it is the only link
