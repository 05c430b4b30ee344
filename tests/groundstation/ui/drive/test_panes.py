"""Panes of the Drive screen: which one is shown, what it needs, and that its keys drive and stop nothing."""

from __future__ import annotations

from functools import partial

import pytest

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, KeyEvent, Keymap
from groundstation.intents.driving import DriveByPicture, DriveKeyDown, Stop
from groundstation.intents.session import SetKeyGate
from groundstation.intents.watch import Watch
from groundstation.ui.drive.pane import PaneFrame
from groundstation.ui.drive.panes import PANES, PaneInput
from groundstation.views.base import ViewRequest
from groundstation.views.camera import CameraRequest, CameraView
from groundstation.views.drive import SpeedRequest, TrackRequest
from groundstation.views.messages import MessagesRequest
from groundstation.views.plan import PlanRequest
from tests.groundstation.ui.drive.instruments.test_instruments import state_of
from tests.groundstation.ui.example_map import VIEWS
from tests.groundstation.ui.examples import MESSAGES_PAGE, SPEEDS, TRACK, snapshot, vehicle, waiting
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

VIEW_KEYS = ("v", "pageup", "pagedown")


def watched(screen: Console) -> tuple[ViewRequest, ...]:
    return screen.station.of(Watch)[-1].requests


def requests_are(screen: Console, expected: tuple[ViewRequest, ...]) -> bool:
    return watched(screen) == expected


async def test_the_key_shows_the_next_pane_and_each_requests_its_needs() -> None:
    async with console() as screen:
        shown = []
        for _ in range(len(PANES) + 1):
            await screen.show(snapshot())
            frame = screen.app.drive.query_one("#pane", PaneFrame)
            expected = frame.requests
            await until(partial(requests_are, screen, expected))
            shown.append(frame.pane.id)
            await screen.press("v")
        assert shown == ["track", "map", "charts", "messages", "log", "links", "horizon", "camera", "track"]


async def test_a_pane_draws_the_view_that_arrives() -> None:
    async with console() as screen:
        assert "nothing yet" not in screen.text
        await screen.press("v", "v", "v")
        assert "nothing yet" in screen.text
        screen.station.offer_view(MESSAGES_PAGE)
        await screen.show(snapshot())
        assert "COMMAND_ACK" in screen.text


@pytest.mark.parametrize("key", VIEW_KEYS)
async def test_the_keys_of_the_pane_neither_stop_nor_close_the_gate(key: str) -> None:
    async with console() as screen:
        screen.app.gate.update(armed=True, driving=True)
        await screen.press("i")
        before = len(screen.station.wishes)
        await screen.press(key)
        assert screen.station.of(DriveKeyDown)
        assert [each for each in screen.station.wishes[before:] if not isinstance(each, Watch)] == []
        assert screen.station.of(SetKeyGate)[-1].open
        await screen.press("x")
        assert screen.station.of(Stop), "another key does stop"


async def test_the_picture_fills_drive_and_the_station_is_told() -> None:
    async with console((120, 40)) as screen:
        screen.app.gate.update(armed=True, driving=True)
        await screen.press("i", "f")
        assert screen.station.of(DriveByPicture) == [DriveByPicture(drives=True)] * len(
            screen.station.of(DriveByPicture)
        )
        assert screen.station.of(SetKeyGate)[-1].open, "the station decides"
        assert not screen.station.of(Stop)
        await screen.show(snapshot())
        await until(lambda: CameraRequest() in watched(screen))
        assert "NO PICTURE YET" in screen.text
        assert "motion" not in screen.text
        screen.station.offer_view(CameraView(1, problem="the vehicle announces no camera"))
        await screen.show(snapshot())
        await screen.show(snapshot())
        await screen.press("f")
        assert screen.station.of(DriveByPicture)[-1] == DriveByPicture(drives=False)
        await screen.show(snapshot())
        assert "motion" in screen.text
        count = len(screen.station.of(DriveByPicture))
        await screen.press("v")
        await screen.show(snapshot())
        assert len(screen.station.of(DriveByPicture)) == count


async def test_what_the_picture_hides_is_up_to_date_after_it() -> None:
    async with console((162, 70)) as screen:
        await screen.show(snapshot(vehicle=vehicle(heading=0.2)))
        before = screen.text
        await until(lambda: SpeedRequest() in watched(screen))
        await screen.press("f")
        await screen.show(snapshot(vehicle=vehicle(heading=2.0)))
        await until(lambda: SpeedRequest() not in watched(screen))
        assert "115°" not in screen.text
        await screen.press("f")
        assert "115°" in screen.text
        assert "115°" not in before
        await until(lambda: SpeedRequest() in watched(screen))


@pytest.mark.parametrize("keymap", KEYMAPS)
def test_only_keys_of_speed_view_and_mute_stop_nothing(keymap: str) -> None:
    keys = Keymap(keymap, KEYMAPS[keymap])
    steady = {action.id for action in ACTIONS.values() if action.steady}
    assert {ACTIONS[each].group for each in steady - {"app.mute"}} == {"speed", "view"}
    for key, action in keys.bindings.items():
        stops = Stop() in keys.build_intents([KeyEvent(key)], armed=True, driving=True)
        drives = isinstance(ACTIONS[action].intent, DriveKeyDown)
        emergency = action == "stop.emergency"
        assert (stops or emergency) == (action not in steady and not drives), key


async def test_zoom_is_kept_for_each_pane() -> None:
    async with console() as screen:
        screen.station.offer_view(TRACK)
        screen.station.offer_view(SPEEDS)
        await screen.show(snapshot())
        whole = screen.text
        await screen.press("pageup")
        assert screen.text != whole
        await screen.press("v", "v", "pageup", "pageup")
        assert "15 s" in screen.text
        await screen.press("pageup", "pageup", "pageup")
        assert "7.5 s" in screen.text, "closer it does not go"
        await screen.press(*("v",) * (len(PANES) - 2), "pagedown")
        assert screen.text == whole


async def test_on_another_screen_the_keys_leave_the_pane_alone() -> None:
    async with console() as screen:
        await screen.press("f7", "v", "escape")
        assert screen.app.drive.query_one("#pane", PaneFrame).pane.id == "track"


async def test_two_panes_side_by_side_are_never_the_same() -> None:
    async with console((180, 50)) as screen:
        for _ in range(len(PANES)):
            first, second = screen.app.drive.query(PaneFrame)
            assert first.pane is not second.pane
            await screen.press("v")
        await until(lambda: {TrackRequest(), SpeedRequest()} <= set(watched(screen)))  # told at the next tick
        assert any(isinstance(each, MessagesRequest) for each in watched(screen))


async def test_nothing_is_requested_without_a_vehicle_or_room() -> None:
    async with console(picture=waiting()) as screen:
        assert screen.app.drive.requests() == ()
    async with console((60, 15)) as screen:
        assert screen.app.drive.requests() == ()


def test_views_of_another_vehicle_are_not_shown() -> None:
    given = PaneInput(state_of(snapshot(vehicle=vehicle(system=2))), {type(TRACK): TRACK, type(SPEEDS): SPEEDS})
    track, charts = PANES[0].value(given), next(pane for pane in PANES if pane.id == "charts").value(given)
    assert track.track == ()
    assert charts.samples == ()


async def test_the_map_pane_shows_the_plans_of_the_vehicle() -> None:
    async with console((140, 45)) as screen:
        await screen.press("v")
        assert screen.app.drive.query_one("#pane", PaneFrame).pane.id == "map"
        await until(lambda: PlanRequest() in watched(screen))
        for view in VIEWS["map"]:
            screen.station.offer_view(view)
        await screen.show(snapshot())
        await screen.show(snapshot())
        assert "no position" not in screen.text
