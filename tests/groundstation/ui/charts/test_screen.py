"""The Charts screen: what it requests and shows, and what keys do on it."""

from __future__ import annotations

import os
from pathlib import Path

from groundstation.intents.charts import PinSeries
from groundstation.intents.driving import EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate, StartSimulator
from groundstation.intents.watch import Watch
from groundstation.ui.charts.screen import ChartsScreen
from groundstation.ui.keys.key_gate import OTHER_SCREEN
from groundstation.views.charts import FieldsRequest, SeriesPage, SeriesRequest
from tests.groundstation.ui.example_charts import DEMAND, NOW, SPEED, TURN, drive, fields_page, points
from tests.groundstation.ui.examples import DRIVE_WATCH, NOON, snapshot, waiting
from tests.groundstation.ui.pilots import Console, console, type_in
from tests.waits import until


async def open_charts(screen: Console, *keys: str) -> None:
    """Open the screen with the view "drive" and its points, then press keys."""
    await screen.press("f5")
    await until(lambda: screen.station.of(Watch))
    screen.station.offer_view(fields_page())
    await screen.show(snapshot())
    assert isinstance(screen.app.screen, ChartsScreen)
    await until(lambda: series(screen).fields == (SPEED, DEMAND, TURN))
    screen.station.offer_view(drive())
    await screen.show(snapshot())
    await screen.press(*keys)


def series(screen: Console) -> SeriesRequest:
    found = screen.station.of(Watch)[-1].requests[0]
    assert isinstance(found, SeriesRequest)
    return found


def search(screen: Console) -> FieldsRequest:
    found = screen.station.of(Watch)[-1].requests[1]
    assert isinstance(found, FieldsRequest)
    return found


async def test_f5_opens_charts_starts_nothing_and_drives_nothing() -> None:
    async with console(picture=waiting()) as screen:
        await screen.press("f5")
        assert isinstance(screen.app.screen, ChartsScreen)
        assert screen.station.of(StartSimulator) == []
        assert (shut := screen.app.gate.closure) is not None
        assert shut.reason == OTHER_SCREEN.reason
        assert screen.station.of(SetKeyGate)[-1].open is False
        await screen.press("space", "exclamation_mark")
        assert screen.station.of(Stop)
        assert screen.station.of(EmergencyStop)


async def test_without_a_vehicle_the_page_names_the_ready_views() -> None:
    async with console(picture=waiting()) as screen:
        await screen.press("f5")
        await until(lambda: screen.station.of(Watch))
        screen.station.offer_view(fields_page(empty=True))
        await screen.show(waiting())
        assert "no vehicle" in screen.text
        assert all(name in screen.text for name in ("drive", "power", "link", "no field yet"))
        await screen.press("v")
        await until(lambda: "no view has a field yet" in screen.text)


async def test_each_page_is_followed_by_a_request_for_what_is_new() -> None:
    async with console() as screen:
        await open_charts(screen)
        await until(lambda: series(screen).after == 2000)
        assert "groundspeed 0.80" in screen.text
        screen.station.offer_view(
            SeriesPage(2001, 2000, NOW + 1, NOON + 61, (points(SPEED, [NOW + 1], lambda at: 0.33),))
        )
        await screen.show(snapshot())
        assert "groundspeed 0.33" in screen.text
        await screen.press("escape")
        await until(lambda: screen.station.of(Watch)[-1] == DRIVE_WATCH)


async def test_a_paused_picture_stays_while_data_go_on() -> None:
    async with console() as screen:
        await open_charts(screen, "z")
        before = screen.text
        screen.station.offer_view(
            SeriesPage(2001, 2000, NOW + 9, NOON + 69, (points(SPEED, [NOW + 9], lambda at: 0.33),))
        )
        await screen.show(snapshot())
        assert "paused, 9 s behind" in screen.text
        assert screen.text.splitlines()[2:20] == before.splitlines()[2:20]
        await screen.press("z")
        assert "groundspeed 0.33" in screen.text


async def test_a_vanished_field_is_a_gap_and_not_a_line() -> None:
    async with console() as screen:
        await open_charts(screen)
        screen.station.offer_view(SeriesPage(2001, 2000, NOW + 30, NOON + 90))
        await screen.show(snapshot())
        assert "groundspeed --" in screen.text
        newest_half_minute = [line[50:] for line in screen.text.splitlines()[3:10]]
        assert not set("".join(newest_half_minute)) - set(" ⠁⡀⠂⠄")  # the grid, and no line


async def test_a_field_is_added_by_part_of_its_name_also_in_one_read() -> None:
    async with console(size=(140, 45)) as screen:
        await open_charts(screen)
        type_in(screen, "avolt\r")
        await until(lambda: search(screen).text == "volt" and search(screen).count > 0)
        screen.station.offer_view(fields_page("volt"))
        await screen.show(snapshot())
        await until(lambda: len(series(screen).fields) == 4)
        assert "4 voltage_battery" in screen.text
        assert search(screen).count == 0
        await screen.press("a", *"xyz", "escape")
        await until(lambda: search(screen).count == 0)
        assert isinstance(screen.app.screen, ChartsScreen)


async def test_pin_is_sent_marked_and_kept_while_the_screen_is_closed() -> None:
    async with console(size=(140, 45)) as screen:
        await open_charts(screen, "p")
        assert screen.station.of(PinSeries) == [PinSeries((SPEED,))]
        assert "━━● groundspeed" in screen.text
        await screen.press("escape", "f5")
        await until(lambda: "━━● groundspeed" in screen.text)
        await screen.press("x")
        assert screen.station.of(PinSeries)[-1] == PinSeries(())


async def test_in_small_terminal_arrows_and_tab_reach_charts_and_list() -> None:
    async with console() as screen:
        await open_charts(screen)
        assert "2 throttle" in screen.text
        assert "3 turn rate" not in screen.text
        await screen.press("down", "down")
        assert "3 turn rate" in screen.text
        assert "1 speed" not in screen.text
        await screen.press("1", "tab")
        await until(lambda: "in the window" in screen.text and "VFR_HUD.groundspeed" in screen.text)
        await screen.press("tab")
        await until(lambda: "1 speed" in screen.text and "in the window" not in screen.text)


async def test_the_hint_line_measures_between_two_cursors() -> None:
    async with console() as screen:
        await open_charts(screen, "2", "shift+left", "m", *["shift+left"] * 6)
        assert "Δt -" in screen.text
        assert "Δ -60.00 %" in screen.text
        await screen.press("c")
        assert "Δt" not in screen.text
        await screen.press("m")
        assert "place the first cursor" in screen.text


async def test_a_view_is_saved_under_a_name(tmp_path: Path) -> None:
    async with console(folder=tmp_path) as screen:
        await open_charts(screen, "S", *"mine", "enter")
        await until(lambda: "view “mine” saved" in screen.text)
        assert os.listdir(tmp_path) == ["chart-views.json"]


async def test_the_first_view_opens_by_itself_once() -> None:
    async with console() as screen:
        await open_charts(screen)
        await screen.press("x", "x", "x")
        screen.station.offer_view(fields_page())
        await screen.show(snapshot())
        assert series(screen).fields == ()
        await screen.press("v")
        await until(lambda: series(screen).fields != ())
