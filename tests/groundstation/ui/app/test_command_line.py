"""The command line of the screens: its keys, the gate under it, and what it does without a vehicle."""

from __future__ import annotations

import msgspec
import pytest

from groundstation.config.settings import ThemeName
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.line import RunLine
from groundstation.intents.links import AddLink
from groundstation.intents.watch import Watch
from groundstation.ui.app.command_history import CommandHistory, complete_text
from groundstation.ui.app.command_line import CommandLine
from groundstation.ui.connect.screen import ConnectScreen
from groundstation.ui.keys.key_gate import TEXT_FIELD
from groundstation.ui.log.screen import LogScreen
from groundstation.ui.map.screen import MapScreen
from groundstation.views.line import ASKS, DONE, FAILED, LineRequest, LineView
from tests.groundstation.ui.examples import snapshot
from tests.groundstation.ui.pilots import Console, console, type_in
from tests.waits import until


async def begin(screen: Console) -> CommandLine:
    """Open the command line."""
    await screen.press("colon")
    await until(lambda: isinstance(screen.app.screen, CommandLine))
    found = screen.app.screen
    assert isinstance(found, CommandLine)
    return found


async def enter(screen: Console, text: str) -> None:
    """Type a line."""
    await begin(screen)
    await screen.press(*(ALIAS.get(letter, letter) for letter in text), "enter")


ALIAS = {" ": "space", ":": "colon", "/": "slash", ".": "full_stop"}


async def answer(screen: Console, state: str, note: str, text: str = "", words: tuple[str, ...] = ()) -> None:
    """Let the station answer the newest line."""
    number = max((each.request for each in screen.station.of(RunLine)), default=0)
    screen.station.offer_view(LineView(number, state, note, text, words))
    await screen.show(msgspec.structs.replace(snapshot()))


async def test_it_is_neutral_and_letters_are_text_but_stop_keys_stop() -> None:
    async with console() as screen:
        screen.station.intents.clear()
        type_in(screen, ":")
        assert any(isinstance(each, Stop) for each in screen.station.intents)
        await until(lambda: isinstance(screen.app.screen, CommandLine))
        await until(lambda: screen.app.gate.closure == TEXT_FIELD)
        screen.station.intents.clear()
        type_in(screen, "ik r2")
        await until(lambda: "ik r2" in screen.text)
        assert not [each for each in screen.station.intents if isinstance(each, Stop)]
        assert all(isinstance(each, (DriveKeyDown, Watch)) or not each.is_input for each in screen.station.intents)
        type_in(screen, "\x0b")
        assert isinstance(screen.station.intents[-1], Stop)
        type_in(screen, "!")
        assert any(isinstance(each, EmergencyStop) for each in screen.station.intents)
        await screen.press("escape")
        await until(lambda: screen.app.gate.closure is None)


async def test_a_line_goes_to_the_station_and_its_end_is_shown() -> None:
    async with console() as screen:
        await screen.press("f6")
        await enter(screen, "mode HOLD")
        [sent] = screen.station.of(RunLine)
        assert (sent.text, sent.system, sent.confirmed) == ("mode HOLD", 1, False)
        await answer(screen, DONE, "Rover 1: mode HOLD: accepted")
        await until(lambda: isinstance(screen.app.screen, LogScreen))
        await until(lambda: "Rover 1: mode HOLD: accepted" in screen.text)


async def test_a_question_is_answered_by_y_and_by_nothing_else() -> None:
    async with console() as screen:
        for key, count in (("n", 1), ("y", 2)):
            screen.station.intents.clear()
            await enter(screen, "mode AUTO")
            await answer(screen, ASKS, "Rover 1: mode AUTO?")
            await until(lambda: "y does it" in screen.text)
            await screen.press(key)
            await until(lambda: screen.app.screen is screen.app.drive)
            assert [each.confirmed for each in screen.station.of(RunLine)] == [False, True][:count]


async def test_a_mistake_stays_to_be_corrected() -> None:
    async with console() as screen:
        await enter(screen, "moed HOLD")
        await answer(screen, FAILED, "'moed' is not a verb")
        await until(lambda: "'moed' is not a verb" in screen.text)
        assert isinstance(screen.app.screen, CommandLine)
        assert screen.app.screen.field.value == "moed HOLD"
        await screen.press("escape")
        line = await begin(screen)
        await screen.press("up")
        assert line.field.value == "moed HOLD"
        await screen.press("down")
        assert line.field.value == ""


async def test_tab_completes_with_the_words_of_the_station() -> None:
    async with console() as screen:
        line = await begin(screen)
        await screen.press("m", "o")
        await until(lambda: any(LineRequest(0, "mo", 1) in each.requests for each in screen.station.of(Watch)))
        await answer(screen, "running", "", "mo", ("modes", "mode"))
        await until(lambda: "modes" in screen.text)
        await screen.press("tab")
        assert line.field.value == "mode"


async def test_words_that_need_no_vehicle(monkeypatch: pytest.MonkeyPatch) -> None:
    async with console() as screen:
        await enter(screen, "map")
        await until(lambda: isinstance(screen.app.screen, MapScreen))
        await enter(screen, "log")
        await until(lambda: isinstance(screen.app.screen, LogScreen))
        await enter(screen, "/arm")
        await until(lambda: "with “arm”" in screen.text)
        await enter(screen, "set theme light")
        await until(lambda: screen.app.theme == ThemeName.LIGHT)
        await enter(screen, "udpout:127.0.0.1:14550")
        await until(lambda: isinstance(screen.app.screen, ConnectScreen))
        assert [each.endpoint for each in screen.station.of(AddLink)] == ["udpout:127.0.0.1:14550"]
        await screen.press("f6")  # on Connect the key is its own field for an endpoint
        await until(lambda: isinstance(screen.app.screen, LogScreen))
        await enter(screen, "udpin:0.0.0.0:14550")
        await until(lambda: "listens to the whole network" in screen.text)
        assert len(screen.station.of(AddLink)) == 1
        assert screen.station.of(RunLine) == []
        await enter(screen, "set theme dark")
        quits: list[bool] = []
        monkeypatch.setattr(screen.app._quitting, "end", lambda: quits.append(True))
        await enter(screen, "q")
        await until(lambda: quits)


def test_history_and_completion() -> None:
    history = CommandHistory()
    for line in ("a", "b", "b", ""):
        history.add(line)
    history.begin()
    assert [history.move(-1, "x"), history.move(-1, ""), history.move(-1, "")] == ["b", "a", "a"]
    assert [history.move(1, ""), history.move(1, ""), history.move(1, "x")] == ["b", "x", "x"]
    assert complete_text("mode SM", ("SMART_RTL",)) == "mode SMART_RTL "
    assert complete_text("param get fs_", ("FS_ACTION", "FS_TIMEOUT")) == "param get FS_"
    assert complete_text("x", ()) == "x"


async def test_a_function_key_leaves_it_for_its_screen() -> None:
    async with console() as screen:
        await begin(screen)
        await screen.press("d", "r", "f6")
        assert isinstance(screen.app.screen, LogScreen)
        await begin(screen)
        await screen.press("f1")
        assert screen.app.drive.is_current
        await until(lambda: screen.app.gate.closure is None)
        assert not screen.station.of(RunLine)
