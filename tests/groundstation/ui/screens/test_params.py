"""The Parameters screen: reading, filtering, changes that are kept here until they are written, undo."""

from __future__ import annotations

import pytest

from groundstation.intents.driving import STOP_KEY, Stop
from groundstation.intents.services import CancelRequest, FetchParams, WriteParams
from groundstation.intents.session import SetKeyGate, Watch
from groundstation.snapshot import Snapshot
from groundstation.ui.key_gate import OTHER_SCREEN, TEXT_FIELD
from groundstation.ui.screens.params import ParamsScreen
from groundstation.views.params import ParamPage, ParamPageRequest
from groundstation.views.requests import RequestLine
from tests.groundstation.ui.examples import DRIVE_WATCH, param_page, snapshot, vehicle
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.ptys import until

EMPTY = ParamPage(1, (), 0, 0, 0, None, has_defaults=False, running=(), ended=())


async def open_params(screen: Console, page: ParamPage | None = None, picture: Snapshot | None = None) -> ParamsScreen:
    await screen.press("f4")
    await until(lambda: screen.station.of(Watch)[-1] != DRIVE_WATCH)
    await offer(screen, page or param_page(), picture)
    top = screen.app.screen
    assert isinstance(top, ParamsScreen)
    return top


async def offer(screen: Console, page: ParamPage, picture: Snapshot | None = None) -> None:
    screen.station.offer_view(page)
    await screen.show(picture or snapshot())
    await screen.show(picture or snapshot())


async def change(screen: Console, value: str) -> None:
    """Give the selected parameter another value."""
    await screen.press(
        "enter", "end", *["backspace"] * 8, *["full_stop" if key == "." else key for key in value], "enter"
    )


async def test_parameters_that_are_not_known_are_read_once() -> None:
    async with console() as screen:
        await open_params(screen, EMPTY)
        await until(lambda: screen.station.of(FetchParams) == [FetchParams(1)])
        await offer(screen, EMPTY)
        assert "no parameters: R reads them again" in screen.text
        assert len(screen.station.of(FetchParams)) == 1
        await screen.press("R")
        assert screen.station.of(FetchParams)[1:] == [FetchParams(2)]


async def test_a_vehicle_whose_parameters_are_known_is_not_asked_again() -> None:
    async with console() as screen:
        await open_params(screen)
        assert "FS_ACTION" in screen.text
        assert "default 1" in screen.text
        assert screen.station.of(FetchParams) == []


async def test_parameters_that_the_station_has_forgotten_are_read_again() -> None:
    async with console() as screen:
        await open_params(screen)
        await offer(screen, EMPTY)
        await until(lambda: screen.station.of(FetchParams) == [FetchParams(1)])


async def test_progress_is_shown() -> None:
    async with console() as screen:
        line = RequestLine(1, "running", "fetch parameters", done=610, total=1235)
        await open_params(screen, param_page(running=(line,)))
        await until(lambda: "fetch parameters 610/1235" in screen.text)
        await screen.press("X")
        assert screen.station.of(CancelRequest) == [CancelRequest(1)]


async def test_only_the_rows_that_fit_are_requested() -> None:
    async with console((80, 24)) as screen:
        await open_params(screen)
        await until(lambda: screen.station.of(Watch)[-1] == Watch((ParamPageRequest(rows=18),)))
        await screen.press("slash", *"fs")
        await until(lambda: screen.station.of(Watch)[-1] == Watch((ParamPageRequest("fs", rows=17),)))
        await screen.press("enter", "c")
        await until(lambda: screen.station.of(Watch)[-1] == Watch((ParamPageRequest("fs", True, rows=18),)))
        await screen.press("slash", "escape")
        await until(lambda: screen.station.of(Watch)[-1] == Watch((ParamPageRequest("", True, rows=18),)))


async def test_a_change_is_sent_after_the_question_only() -> None:
    async with console() as screen:
        await open_params(screen)
        await change(screen, "0")
        await until(lambda: "2 → 0" in screen.text)
        await screen.press("W")
        await until(lambda: "write 1 change to the vehicle, which is ARMED · y does it" in screen.text)
        await screen.press("n")
        await until(lambda: "y does it" not in screen.text)
        await screen.press("y")
        assert screen.station.of(WriteParams) == []
        await screen.press("W", "y")
        assert screen.station.of(WriteParams) == [WriteParams(1, 1, (("FS_ACTION", 0.0),))]
        await screen.press("W", "y")
        assert len(screen.station.of(WriteParams)) == 1, "one write at a time"


async def test_what_was_written_can_be_undone_and_what_was_refused_stays() -> None:
    async with console() as screen:
        await open_params(screen)
        await change(screen, "0")
        await screen.press("down", "down")
        await change(screen, "99")
        await screen.press("W", "y")
        why = "FS_TIMEOUT not changed: 99 is too much (1 of 2 set)"
        line = RequestLine(1, "refused", "set 2 parameters", why, 1, 2)
        await offer(screen, param_page(("FS_ACTION", 0.0), ended=(line,)))
        await until(lambda: f"refused: {why}" in screen.text)
        assert "1.5 → 99" in screen.text
        assert "2 → 0" not in screen.text
        await screen.press("u")
        await until(lambda: "0 → 2" in screen.text)


async def test_changes_outlive_the_screen_and_numbers_go_on() -> None:
    async with console() as screen:
        await open_params(screen)
        await screen.press("d", "W", "y")
        assert [intent.request for intent in screen.station.of(WriteParams)] == [1]
        await screen.press("escape")
        await until(lambda: screen.app.screen is screen.app.drive)
        line = RequestLine(1, "no answer", "set 1 parameter", "after 8 tries", 0, 1)
        await open_params(screen, param_page(ended=(line,)))
        await until(lambda: "2 → 1" in screen.text and "after 8 tries" in screen.text)
        await screen.press("W", "y")
        assert [intent.request for intent in screen.station.of(WriteParams)] == [1, 2]


async def test_default_drop_and_undo() -> None:
    async with console() as screen:
        await open_params(screen)
        await screen.press("d")
        await until(lambda: "2 → 1" in screen.text)
        await screen.press("x")
        await until(lambda: "2 → 1" not in screen.text)
        await screen.press("u")
        await until(lambda: "2 → 1" in screen.text)
        await screen.press("u")
        await until(lambda: "2 → 1" not in screen.text)
        await screen.press("u")
        await until(lambda: "nothing to undo" in screen.text)
        await screen.press("down", "down", "down", "d")
        await until(lambda: "does not report the default" in screen.text)


@pytest.mark.parametrize(
    ("value", "words"),
    [("x", "'x' is not a number"), ("1.5", "FS_ACTION is INT8: whole numbers only"), ("nan", "'nan' cannot be set")],
)
async def test_what_cannot_be_set_is_said_at_once(value: str, words: str) -> None:
    async with console() as screen:
        await open_params(screen)
        await change(screen, value)
        await until(lambda: words in screen.text)
        assert "not sent" not in screen.text


async def test_changes_of_one_vehicle_do_not_go_to_another() -> None:
    async with console() as screen:
        await open_params(screen)
        await screen.press("d")
        await until(lambda: "2 → 1" in screen.text)
        other = snapshot(vehicle=vehicle(system=2))
        await offer(screen, ParamPage(2, param_page().rows, 0, 6, 6, 6, has_defaults=True, running=(), ended=()), other)
        await until(lambda: "2 → 1" not in screen.text)
        await screen.press("W", "y")
        assert screen.station.of(WriteParams) == []


async def test_keys_do_not_drive_here() -> None:
    async with console() as screen:
        await open_params(screen)
        assert screen.app.gate.closure == OTHER_SCREEN
        assert not screen.station.of(SetKeyGate)[-1].open
        await screen.press("slash")
        await until(lambda: screen.app.gate.closure == TEXT_FIELD)
        await screen.press(*"ijkl")
        assert not screen.station.of(SetKeyGate)[-1].open
        assert STOP_KEY not in [stop.reason for stop in screen.station.of(Stop)], "letters are no stop keys in a text"


async def test_names_from_the_link_cannot_write_to_the_terminal() -> None:
    page = param_page()
    evil = ParamPage(
        1, (page.rows[0].__class__(name="A\x1b[2J", value=1.0, kind="INT8", default=None, changed=False),), 0, 1, 1, 1,
        has_defaults=False, running=(), ended=(),
    )  # fmt: skip
    async with console() as screen:
        await open_params(screen, evil)
        await until(lambda: "A�[2J" in screen.text)
