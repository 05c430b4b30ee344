"""The Map screen: its keys, what asks first, what is sent, files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from msgspec.structs import replace

from groundstation.intents.driving import STOP_KEY, Stop
from groundstation.intents.plan import (
    ChooseMode,
    ClearPlan,
    DownloadPlan,
    EnableFence,
    GoTo,
    JumpToItem,
    PauseMission,
    SetHome,
    StartMission,
    UploadPlan,
)
from groundstation.intents.services import CancelRequest
from groundstation.intents.watch import Watch
from groundstation.snapshot import Snapshot
from groundstation.snapshot.drive import StopBound
from groundstation.ui.map.model import MapModel
from groundstation.ui.map.screen import MapScreen
from groundstation.views.base import View
from groundstation.views.plan import PlanKind, PlanRequest, PlanSummary, PlanTrackRequest
from groundstation.views.requests import RequestLine
from tests.groundstation.ui.example_map import (
    LOADING,
    MISSION,
    NONE,
    pages,
    picture,
    plan_view,
    track,
)
from tests.groundstation.ui.examples import waiting
from tests.groundstation.ui.map.plans import at
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

STANDING = picture(armed=False, mode="HOLD", speed=0.0)
READY = picture(armed=True, mode="MANUAL", speed=0.0)
ALL: tuple[View, ...] = (plan_view(), *pages(), track())


async def open_map(screen: Console, shows: Snapshot = STANDING, views: tuple[View, ...] = ALL) -> MapModel:
    await screen.press("f2")
    for view in views:
        screen.station.offer_view(view)
    await screen.show(shows)
    await screen.press("f")
    top = screen.app.screen
    assert isinstance(top, MapScreen)
    return top._model


async def type_text(screen: Console, text: str) -> None:
    await screen.press(*["full_stop" if letter == "." else letter for letter in text], "enter")


async def test_plans_that_are_not_known_are_downloaded_once() -> None:
    async with console() as screen:
        await open_map(screen, views=(plan_view(plans=NONE),))
        assert screen.station.of(DownloadPlan) == [DownloadPlan(1, 1, 0), DownloadPlan(2, 1, 1), DownloadPlan(3, 1, 2)]
        screen.station.offer_view(plan_view(plans=NONE, place=None))
        await screen.show(STANDING)
        assert len(screen.station.of(DownloadPlan)) == 3
        assert screen.station.of(Watch)[-1] == Watch((PlanRequest(), PlanTrackRequest()))


async def test_a_mission_is_drawn_with_the_cursor_and_uploaded() -> None:
    async with console() as screen:
        empty = plan_view(plans=(PlanSummary(1), PlanSummary(1), PlanSummary(1)), reached=(), current=None, state=1)
        model = await open_map(screen, views=(empty,))
        await screen.press("up", "up", "a", *["right"] * 5, "a")
        assert len(model.editor.rows()) == 2
        await until(lambda: "2 new, not on the vehicle: U uploads" in screen.text)
        await until(lambda: "Map✎" in screen.text)
        await screen.press("U")
        [upload] = screen.station.of(UploadPlan)
        assert (upload.system, upload.kind, upload.items) == (1, 0, model.editor.items(PlanKind.MISSION))
        assert upload.home_altitude == 584.0


async def test_an_upload_while_armed_asks() -> None:
    async with console() as screen:
        await open_map(screen, picture())
        await screen.press("tab", "end", "x", "U")
        await until(lambda: "upload the mission (1 removed) while Rover 1 is ARMED · y does it" in screen.text)
        await screen.press("n", "y")
        assert screen.station.of(UploadPlan) == []
        await screen.press("U", "y")
        assert len(screen.station.of(UploadPlan)) == 1


@pytest.mark.parametrize(
    ("key", "words", "kind"),
    [
        ("G", "Rover 1 drives to the cursor, ", GoTo),
        ("H", "move home to the cursor, ", SetHome),
        ("X", "clear the mission on Rover 1", ClearPlan),
        ("J", "jump to item 0 WAYPOINT", JumpToItem),
        ("P", "start the mission: Rover 1 drives by itself", StartMission),
        ("3", "change to AUTO, in which the vehicle moves by itself", ChooseMode),
        ("5", "change to RTL, in which the vehicle moves by itself", ChooseMode),
    ],
)
async def test_what_moves_the_vehicle_or_clears_its_plan_asks(key: str, words: str, kind: type) -> None:
    async with console((140, 45)) as screen:
        await open_map(screen, READY)
        await screen.press(key)
        await until(lambda: words in screen.text)
        await screen.press("x")
        assert screen.station.of(kind) == []
        await screen.press(key, "y")
        assert len(screen.station.of(kind)) == 1


@pytest.mark.parametrize("key", ["P", "G"])
async def test_disarmed_the_map_says_arm_first_and_asks_nothing(key: str) -> None:
    async with console((140, 45)) as screen:
        await open_map(screen, picture(armed=False))
        await screen.press(key)
        assert "Rover 1 is disarmed: arm it first, on Drive" in screen.text
        await screen.press("y")
        assert not screen.station.of(StartMission)
        assert not screen.station.of(GoTo)


async def test_what_stops_does_not_ask() -> None:
    async with console() as screen:
        await open_map(screen, picture())
        await screen.press("P")
        assert screen.station.of(PauseMission) == [PauseMission(1, 1)]
        await screen.press("2", "1")
        assert [each.mode for each in screen.station.of(ChooseMode)] == ["HOLD", "MANUAL"]
        await screen.press("space")
        assert Stop(STOP_KEY) in screen.station.of(Stop)
        await screen.press("6")
        await until(lambda: "change to LOITER" in screen.text)
        await screen.press("space")
        assert screen.station.of(Stop).count(Stop(STOP_KEY)) == 2, "SPACE stops, also while a question waits"


async def test_a_mode_that_the_vehicle_lacks() -> None:
    async with console() as screen:
        await open_map(screen, views=(plan_view(modes=()),))
        await screen.press("3")
        await until(lambda: "this vehicle has no mode AUTO or AUTO_MISSION" in screen.text)
        assert screen.station.of(ChooseMode) == []


async def test_fields_are_edited_in_the_item_panel() -> None:
    async with console((140, 45)) as screen:
        model = await open_map(screen)
        await screen.press("tab", "enter", "down", "enter", *["backspace"] * 12)
        await type_text(screen, "95")
        await until(lambda: "latitude is -90 to 90" in screen.text)
        await screen.press("down", "down", "down", "enter", "backspace")
        await type_text(screen, "4.5")
        await until(lambda: model.editor.items(PlanKind.MISSION)[0].params[0] == 4.5)
        await until(lambda: "was 0" in screen.text)
        await screen.press("home", "enter")
        await type_text(screen, "speed")
        await until(lambda: model.editor.items(PlanKind.MISSION)[0].command == 178)
        await until(lambda: "was WAYPOINT" in screen.text)
        await screen.press("u", "u")
        assert model.editor.items(PlanKind.MISSION) == MISSION
        await screen.press("ctrl+r")
        assert model.editor.items(PlanKind.MISSION)[0].params[0] == 4.5
        await screen.press("escape", "escape")
        assert isinstance(screen.app.screen, MapScreen), "one step after the other"
        await screen.press("escape")
        assert not isinstance(screen.app.screen, MapScreen)


async def test_layers_order_and_measuring() -> None:
    async with console((140, 45)) as screen:
        model = await open_map(screen)
        await screen.press("tab", "greater_than_sign")
        await until(lambda: "other order" in screen.text)
        await screen.press("less_than_sign")
        assert model.editor.edited == ()
        await screen.press("e")
        await until(lambda: "✎ fence" in screen.text)
        await until(lambda: "polygon in" in screen.text)
        await screen.press("p", "e")
        await until(lambda: "✎ rally points" in screen.text)
        await screen.press("tab", "tab", "b", *["right"] * 4)
        await until(lambda: "measured" in screen.text)
        await screen.press("c")
        await until(lambda: "following" in screen.text)
        before = model.ground.window.zoom
        await screen.press("minus", "minus", "plus")
        assert model.ground.window.zoom == before + 1


async def test_a_plan_that_cannot_be_used_is_not_sent() -> None:
    async with console() as screen:
        await open_map(screen)
        await screen.press("e", "p", "U")
        await until(lambda: "not uploaded: item 6: a polygon needs 3 corners, this one has 1" in screen.text)
        assert screen.station.of(UploadPlan) == []


async def test_transfers_are_shown_and_cancelled() -> None:
    async with console() as screen:
        await open_map(screen, views=(LOADING,))
        await until(lambda: "download mission 12/50 ██░░░░░░░░" in screen.text)
        await until(lambda: "loading the mission 12/50" in screen.text)
        await screen.press("C")
        assert screen.station.of(CancelRequest) == [CancelRequest(1)]


async def test_another_vehicle_does_not_get_the_request_of_the_first() -> None:
    async with console() as screen:
        await open_map(screen, READY)
        await screen.press("G")
        screen.station.offer_view(plan_view(system=2, name="Rover 2"))
        await screen.show(STANDING)
        await screen.press("y")
        await until(lambda: "another vehicle is selected: nothing was sent" in screen.text)
        assert screen.station.of(GoTo) == []


async def test_edits_stay_when_the_screen_is_closed() -> None:
    async with console((140, 45)) as screen:
        await open_map(screen)
        await screen.press("a", "escape")
        await until(lambda: "Map✎" in screen.text)
        model = await open_map(screen)
        assert model.editor.diff(PlanKind.MISSION).text == "1 new"


async def test_files_are_saved_and_opened(tmp_path: Path) -> None:
    async with console((140, 45), folder=tmp_path) as screen:
        model = await open_map(screen)
        await screen.press("S")
        await type_text(screen, "park.plan")
        await until(lambda: "saved" in screen.app.screen.hint)  # type: ignore[attr-defined]
        await screen.press("tab", "x", "x")
        assert len(model.editor.rows()) == len(MISSION) - 2
        await screen.press("O", "enter")
        await until(lambda: len(model.editor.rows()) == len(MISSION))
        assert model.file == "park.plan"
        await screen.press("S", "enter")
        await until(lambda: "park.plan exists already: overwrite it · type overwrite" in screen.text)
        await screen.press("escape", "O", *["backspace"] * 9)
        await type_text(screen, "no.plan")
        await until(lambda: "No such file" in screen.app.screen.hint)  # type: ignore[attr-defined]


def write_layer(file: Path, *features: tuple[str, object, str]) -> None:
    found = [
        {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": {"name": name}}
        for kind, coordinates, name in features
    ]
    file.write_text(json.dumps({"type": "FeatureCollection", "features": found}))


def around(*points: tuple[float, float]) -> list[list[float]]:
    return [[at(*point).longitude, at(*point).latitude] for point in points]


async def test_a_geojson_file_is_a_layer_behind_the_plans(tmp_path: Path) -> None:
    corners = around((60, -20), (60, 20), (-30, 20), (-30, -20))
    write_layer(tmp_path / "a.geojson", ("Polygon", [corners], "meadow"), ("Point", around((5, 5))[0], "gate"))
    async with console((140, 45), folder=tmp_path) as screen:
        model = await open_map(screen)
        before = screen.text
        await screen.press("O")
        await type_text(screen, "a.geojson")
        await until(lambda: "a.geojson: 1 point, 1 area" in screen.text)
        await screen.show(STANDING)
        assert "meadow" in screen.text
        assert "gate" in screen.text
        assert not model.editor.edited, "it is not a plan"
        await screen.press("l")
        assert "layers hidden" in screen.text
        assert "meadow" not in screen.text
        await screen.press("l", "l", "f")
        assert [line for line in screen.text.splitlines() if "⌂" in line] == [
            line for line in before.splitlines() if "⌂" in line
        ], "the map is as before"


async def test_a_damaged_layer_is_one_line_and_a_far_one_is_not_fitted(tmp_path: Path) -> None:
    (tmp_path / "bad.geojson").write_text('{"type": "Point", "coordinates": [8.0, NaN]}')
    write_layer(tmp_path / "far.geojson", ("Point", [2.35, 48.85], "Paris"))
    async with console((140, 45), folder=tmp_path) as screen:
        model = await open_map(screen)
        scale = model.ground.window.scale
        await screen.press("O")
        await type_text(screen, "bad.geojson")
        await until(lambda: "bad.geojson: position 1: latitude nan is not in -90 to 90" in screen.text)
        await screen.press("O", *["backspace"] * 11)
        await type_text(screen, "far.geojson")
        await until(lambda: "far.geojson: 1 point, 1" in screen.text)
        assert "km away at" in screen.text
        assert "f does not show it" in screen.text
        assert model.ground.window.scale == scale


async def test_a_layer_alone_makes_a_map_without_any_vehicle(tmp_path: Path) -> None:
    write_layer(tmp_path / "a.geojson", ("LineString", around((0, 0), (0, 30)), "path"))
    async with console((140, 45), waiting(), folder=tmp_path) as screen:
        await screen.press("f2", "O")
        await type_text(screen, "a.geojson")
        await until(lambda: "1 line" in screen.text)
        await screen.show(waiting())
        assert "path" in screen.text


async def test_the_place_of_the_cursor_is_copied() -> None:
    async with console() as screen:
        model = await open_map(screen)
        await screen.press("y")
        assert model.ground.cursor is not None
        text = f"{model.ground.cursor.latitude:.7f}, {model.ground.cursor.longitude:.7f}"
        assert screen.app.clipboard == text
        assert f"copied {text}" in screen.text


async def test_the_table_is_filtered_and_its_arrows_stay_in_it() -> None:
    async with console((140, 45)) as screen:
        model = await open_map(screen)
        await screen.press("slash", *"loiter", "enter")
        shown = list(model.shown_rows)
        assert len(shown) == 1
        assert f"/loiter 1 of {len(MISSION)} items" in screen.text
        assert "WAYPOINT" not in screen.text.split("LOITER_TIME")[0].splitlines()[-1]
        await screen.press("tab", "down", "up", "end")
        assert model.editor.selected == shown[0]
        await screen.press("slash", *["backspace"] * 6, *"nothing", "enter")
        assert "no item has 'nothing'" in screen.text
        count = len(model.editor.rows())
        await screen.press("down", "x")
        assert "the filter hides the selected item" in screen.text
        assert len(model.editor.rows()) == count
        await screen.press("escape")
        assert len(model.shown_rows) == len(model.editor.rows())
        await screen.press("a", "slash", *"new", "enter")
        assert [model.editor.rows()[index].origin for index in model.shown_rows] == [None]


OFF = StopBound("fence", "nothing", "FENCE_ENABLE", never=True, unit="m")
UPLOADED = RequestLine(7, "accepted", "upload fence of 6 items", "", 6, 6, "plan", system=1)


async def test_a_fence_that_is_off_says_so_where_one_looks() -> None:
    async with console((140, 45)) as screen:
        await open_map(screen, picture(armed=True, mode="MANUAL", stops=(OFF,)))
        assert "6 items, OFF" in screen.text
        assert "fence OFF" in screen.text
        await screen.press("P")
        assert "drives by itself; the fence is OFF" in screen.text
        await screen.press("x", "F")
        assert [each.on for each in screen.station.of(EnableFence)] == [True]


async def test_a_fence_that_is_on_is_switched_off_after_a_question() -> None:
    async with console((140, 45)) as screen:
        await open_map(screen, picture(armed=True, mode="MANUAL", stops=()))
        assert "OFF" not in screen.text
        await screen.press("F")
        assert "nothing keeps Rover 1 inside it" in screen.text
        await screen.press("x")
        assert screen.station.of(EnableFence) == []
        await screen.press("F", "y")
        assert [each.on for each in screen.station.of(EnableFence)] == [False]


async def test_after_an_upload_a_fence_that_is_off_can_be_switched_on() -> None:
    async with console((140, 45)) as screen:
        shown = picture(armed=False, mode="HOLD", stops=(OFF,))
        await open_map(screen, shown)
        screen.station.offer_view(plan_view(ended=(UPLOADED,)))
        await screen.show(shown)
        assert "the fence is on the vehicle, but switched off: switch it on" in screen.text
        again = tuple(PlanSummary(2, plan.count) for plan in plan_view().plans)
        screen.station.offer_view(plan_view(plans=again))  # the plans that the vehicle has are read back meanwhile
        for page in pages():
            screen.station.offer_view(replace(page, version=2))
        await screen.show(shown)
        await screen.press("y")
        assert [each.on for each in screen.station.of(EnableFence)] == [True]
