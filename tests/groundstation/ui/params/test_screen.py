"""The Parameters screen: reading, filtering, changes that are kept here until they are written, undo."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import pytest

from groundstation.intents.driving import STOP_KEY, Stop
from groundstation.intents.services import (
    CancelRequest,
    CompareParams,
    FetchParams,
    ResetParams,
    StoreParams,
    WriteParams,
)
from groundstation.intents.session import SetKeyGate
from groundstation.intents.watch import Watch
from groundstation.snapshot import Snapshot
from groundstation.ui.keys.key_gate import OTHER_SCREEN, TEXT_FIELD
from groundstation.ui.params.screen import ParamsScreen
from groundstation.views.base import ViewRequest
from groundstation.views.params import (
    ParamDiffRequest,
    ParamExport,
    ParamExportRequest,
    ParamInfoRequest,
    ParamInfos,
    ParamPage,
    ParamPageRequest,
)
from groundstation.views.requests import RequestLine
from tests.groundstation.ui.example_params import DIFF, HOLES, INFOS, PAGE, page
from tests.groundstation.ui.examples import DRIVE_WATCH, param_page, snapshot, vehicle
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

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


def requested(screen: Console) -> list[ViewRequest]:
    """What the screen has requested last."""
    return list(screen.station.of(Watch)[-1].requests)


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
        assert screen.station.of(FetchParams) == []


async def test_parameters_the_station_has_forgotten_are_read_again() -> None:
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
        await until(lambda: requested(screen)[:2] == [ParamPageRequest(rows=17), ParamInfoRequest(("FS_ACTION",))])
        await screen.press("slash", *"fs")
        await until(lambda: requested(screen)[0] == ParamPageRequest("fs", rows=16))
        await screen.press("enter", "c")
        await until(lambda: requested(screen)[0] == ParamPageRequest("fs", True, rows=17))
        await screen.press("slash", "escape")
        await until(lambda: requested(screen)[0] == ParamPageRequest("", True, rows=17))


async def test_a_change_is_sent_after_the_question_only() -> None:
    async with console() as screen:
        await open_params(screen)
        await change(screen, "0")
        await until(lambda: "2→0" in screen.text)
        await screen.press("W")
        await until(lambda: "write 1 change to the vehicle, which is ARMED (care: FS_ACTION) · y" in screen.text)
        await screen.press("n")
        await until(lambda: "y does it" not in screen.text)
        await screen.press("y")
        assert screen.station.of(WriteParams) == []
        await screen.press("W", "y")
        assert screen.station.of(WriteParams) == [WriteParams(1, 1, (("FS_ACTION", 0.0),))]
        await screen.press("W", "y")
        assert len(screen.station.of(WriteParams)) == 1, "one write at a time"


async def test_a_written_value_can_be_undone_and_a_refused_one_stays() -> None:
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
        assert "1.5→99" in screen.text
        assert "2→0" not in screen.text
        await screen.press("u")
        await until(lambda: "0→2" in screen.text)


async def test_changes_outlive_the_screen_and_numbers_go_on() -> None:
    async with console() as screen:
        await open_params(screen)
        await screen.press("d", "W", "y")
        assert [intent.request for intent in screen.station.of(WriteParams)] == [1]
        await screen.press("escape")
        await until(lambda: screen.app.screen is screen.app.drive)
        line = RequestLine(1, "no answer", "set 1 parameter", "after 8 tries", 0, 1)
        await open_params(screen, param_page(ended=(line,)))
        await until(lambda: "2→1" in screen.text and "after 8 tries" in screen.text)
        await screen.press("W", "y")
        assert [intent.request for intent in screen.station.of(WriteParams)] == [1, 2]


async def test_default_drop_and_undo() -> None:
    async with console() as screen:
        await open_params(screen)
        await screen.press("d")
        await until(lambda: "2→1" in screen.text)
        await screen.press("x")
        await until(lambda: "2→1" not in screen.text)
        await screen.press("u")
        await until(lambda: "2→1" in screen.text)
        await screen.press("u")
        await until(lambda: "2→1" not in screen.text)
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
        assert "nothing is written" not in screen.text


async def test_changes_of_one_vehicle_do_not_go_to_another() -> None:
    async with console() as screen:
        await open_params(screen)
        await screen.press("d")
        await until(lambda: "2→1" in screen.text)
        other = snapshot(vehicle=vehicle(system=2))
        await offer(screen, ParamPage(2, param_page().rows, 0, 6, 6, 6, has_defaults=True, running=(), ended=()), other)
        await until(lambda: "2→1" not in screen.text)
        await screen.press("W", "y")
        assert screen.station.of(WriteParams) == []


async def test_keys_do_not_drive_here() -> None:
    async with console() as screen:
        await open_params(screen)
        assert (shut := screen.app.gate.closure) is not None
        assert shut.reason == OTHER_SCREEN.reason
        assert not screen.station.of(SetKeyGate)[-1].open
        await screen.press("slash")
        await until(lambda: screen.app.gate.closure == TEXT_FIELD)
        await screen.press(*"ijkl")
        assert not screen.station.of(SetKeyGate)[-1].open
        assert STOP_KEY not in [stop.reason for stop in screen.station.of(Stop)], "letters are not stop keys in a text"


async def test_names_from_the_link_cannot_write_to_the_terminal() -> None:
    page = param_page()
    evil = ParamPage(
        1, (page.rows[0].__class__(name="A\x1b[2J", value=1.0, kind="INT8", default=None, changed=False),), 0, 1, 1, 1,
        has_defaults=False, running=(), ended=(),
    )  # fmt: skip
    async with console() as screen:
        await open_params(screen, evil)
        await until(lambda: "A�[2J" in screen.text)


async def open_described(screen: Console) -> ParamsScreen:
    """Open the screen with a vehicle whose parameters have texts."""
    top = await open_params(screen, PAGE)
    screen.station.offer_view(ParamInfos(1, INFOS))
    await screen.show(snapshot())
    return top


async def test_a_value_is_chosen_by_its_name() -> None:
    async with console() as screen:
        await open_described(screen)
        await screen.press("enter", "end", "backspace", *"smhold")
        await until(lambda: "values (1 of 7)" in screen.text)
        await screen.press("enter")
        await until(lambda: "+ 4 SmartRTL" in screen.text)


async def test_bits_are_toggled_and_escape_leaves_the_value() -> None:
    async with console() as screen:
        await open_described(screen)
        await screen.press(*["down"] * 5, "enter", "down", "tab")
        await until(lambda: "new value   3" in screen.text)
        await screen.press("escape")
        await until(lambda: "new value" not in screen.text)
        await screen.press("enter", "down", "tab", "enter")
        await until(lambda: "1→3" in screen.text)


async def test_a_value_outside_its_range_is_a_warning_and_possible() -> None:
    async with console() as screen:
        await open_described(screen)
        await screen.press("end", "up", "up")
        await change(screen, "121")
        await until(lambda: "outside 0 … 120 !" in screen.text)
        await screen.press("W", "y")
        assert screen.station.of(WriteParams) == [WriteParams(1, 1, (("RC_OVERRIDE_TIME", 121.0),))]


async def test_the_rounding_to_float32_is_shown() -> None:
    async with console() as screen:
        await open_described(screen)
        await screen.press("end", "up", "up", "enter", "end", "backspace", *"1", "full_stop", *"23456789")
        await until(lambda: "1.2345679 rounded" in screen.text)


async def test_groups_are_chosen_in_their_own_panel() -> None:
    async with console((80, 24)) as screen:
        await open_described(screen)
        await screen.press("tab", "end", "enter")
        await until(lambda: requested(screen)[0] == ParamPageRequest(rows=17, group="SERVO"))
        assert "parameters · SERVO" in screen.text
        await screen.press("tab", "home", "down", "down", "enter")
        await until(lambda: requested(screen)[0] == ParamPageRequest(rows=17, names=()))
        await screen.press("tab", "escape")
        assert isinstance(screen.app.screen, ParamsScreen), "ESC goes to the table first"


async def test_a_favourite_is_kept_and_listed(tmp_path: Path) -> None:
    async with console((140, 45)) as screen:
        await open_described(screen)
        await screen.press("asterisk")
        await until(lambda: "★ FS_ACTION" in screen.text)
    assert (tmp_path / "state/mavhelm/favourite-params-ardupilot.txt").read_text() == "FS_ACTION\n"


async def test_a_damaged_file_of_favourites_is_said_once(tmp_path: Path) -> None:
    folder = tmp_path / "state/mavhelm"
    folder.mkdir(parents=True)
    (folder / "favourite-params-ardupilot.txt").write_bytes(b"\xff")
    async with console((140, 45)) as screen:
        await open_described(screen)
        await until(lambda: "favourites ignored: " in screen.text)


async def test_a_file_is_compared_and_its_values_are_taken(tmp_path: Path) -> None:
    (tmp_path / "a.param").write_text("RC_OVERRIDE_TIME 0.5\n")
    async with console((140, 45), folder=tmp_path) as screen:
        await open_described(screen)
        await screen.press("O", *"no", "enter")
        await until(lambda: "no: there is no such file" in screen.text)
        await screen.press("O", "a", "full_stop", *"param", "enter")
        assert screen.station.of(CompareParams) == [CompareParams(1, 1, "a.param", "RC_OVERRIDE_TIME 0.5\n")]
        await offer(screen, page(file="a.param"))
        assert requested(screen)[-1] == ParamDiffRequest()
        screen.station.offer_view(DIFF)
        await screen.show(snapshot())
        assert "rover-safe.param: 3 differ" in screen.text
        await screen.press("tab", "tab", "down", "enter")
        await until(lambda: "✎ COMPASS_OFS_X" in screen.text)
        assert "✎ ATC_STR_RAT_FF" not in screen.text
        await screen.press("a")
        await until(lambda: "3 values of the file are pending" in screen.text)
        await screen.press("W", "y")
        changes = (("ATC_STR_RAT_FF", 0.75), ("COMPASS_OFS_X", 12.9), ("RC_OVERRIDE_TIME", 0.5))
        assert screen.station.of(WriteParams)[0].changes == changes


async def test_a_file_is_saved_and_one_that_is_there_only_after_a_word(tmp_path: Path) -> None:
    async with console((140, 45), folder=tmp_path) as screen:
        await open_described(screen)
        await screen.press("S", "a", "full_stop", *"parm", "space", *"changed", "enter")
        await until(lambda: requested(screen)[-1] == ParamExportRequest(1, "mavproxy", changed_only=True))
        screen.station.offer_view(ParamExport(1, "A 1\n", 1))
        await screen.show(snapshot())
        await until(lambda: "1 parameter saved to " in screen.text)
        assert (tmp_path / "a.parm").read_text() == "A 1\n"
        await screen.press("S", "a", "full_stop", *"parm", "space", *"group", "space", *"mp", "enter")
        await until(lambda: "type overwrite" in screen.text)
        await screen.press(*"overwrite")
        await until(lambda: requested(screen)[-1] == ParamExportRequest(2, "mp", group="FS"))
        screen.station.offer_view(ParamExport(2, "", 0, "there is nothing to save"))
        await screen.show(snapshot())
        await until(lambda: "not saved: there is nothing to save" in screen.text)
        assert (tmp_path / "a.parm").read_text() == "A 1\n"


async def test_enter_alone_saves_under_a_name_that_is_free(tmp_path: Path) -> None:
    async with console((140, 45), folder=tmp_path) as screen:
        await open_described(screen)
        await screen.press("S")
        name = screen.text.partition("ENTER alone: ")[2].split()[0]
        assert name.startswith("rover-1-2")
        await screen.press("enter")
        await until(lambda: requested(screen)[-1] == ParamExportRequest(1, "mavproxy"))
        screen.station.offer_view(ParamExport(1, "A 1\n", 1))
        await screen.show(snapshot())
        await until(lambda: (tmp_path / name).exists())
        await screen.press("S")
        assert "-2.param" in screen.text


async def test_store_asks_once_and_reset_wants_the_word() -> None:
    async with console((140, 45)) as screen:
        await open_described(screen)
        await screen.press("E", *"nothing", "enter")
        await until(lambda: "type store or reset" in screen.text)
        await screen.press("E", *"store", "enter", "y")
        assert screen.station.of(StoreParams) == [StoreParams(1, 1)]
        await screen.press("E", *"reset", "enter", "y")
        assert screen.station.of(ResetParams) == []
        await screen.press("E", *"reset", "enter", *"reset")
        assert screen.station.of(ResetParams) == [ResetParams(2, 1)]
        await offer(screen, page(ended=(RequestLine(2, "accepted", "reset the parameters"),)))
        assert screen.station.of(FetchParams) == [FetchParams(3)], "their values are read again"


async def test_what_is_missing_is_named() -> None:
    async with console((140, 45)) as screen:
        await open_params(screen, HOLES)
        await until(lambda: "9 missing (index 17, 18, 19, 400, 401, 402 …): R asks for them" in screen.text)
        await screen.press("R")
        assert screen.station.of(FetchParams) == [FetchParams(1)]


async def test_redo() -> None:
    async with console() as screen:
        await open_params(screen)
        await screen.press("d", "u", "ctrl+r")
        await until(lambda: "2→1" in screen.text)
        await screen.press("ctrl+r")
        await until(lambda: "nothing to redo" in screen.text)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 3.4e38])
async def test_a_vehicle_may_send_values_that_are_no_numbers(value: float) -> None:
    odd = [msgspec.structs.replace(row, value=value, default=value) for row in PAGE.rows]
    infos = tuple(msgspec.structs.replace(info, value=value, default=value) for info in INFOS)
    async with console((140, 45)) as screen:
        await open_params(screen, page(rows=tuple(odd)))
        screen.station.offer_view(ParamInfos(1, infos))
        await screen.show(snapshot())
        for _ in odd:
            await screen.press("enter", "tab", "down", "escape", "down")
        assert "RC_OVERRIDE_TIME" in screen.text


async def test_y_copies_the_selected_parameter() -> None:
    async with console() as screen:
        top = await open_params(screen, PAGE)
        await screen.press("down", "y")
        assert top._model.selected is not None
        assert screen.app.clipboard.startswith(f"{top._model.selected.name} ")
