"""The detail of a line of the log, and which lines belong together."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from msgspec.structs import replace

from dialects.enums import Result, Severity, result_token
from groundstation.snapshot import LogLine
from groundstation.ui.log.detail import RESULTS, SEVERITY_MEANINGS, describe, result_text
from groundstation.ui.log.filter import SEVERITY_NAMES
from groundstation.ui.log.join import LogGroup, find_group
from groundstation.ui.look.appearance import Look
from tests.groundstation.ui.example_log import (
    ARM,
    ARMED,
    BACK,
    FOUND,
    LINES,
    MODE,
    OTHERS,
    REASON,
    REFUSAL_PAGE,
    REFUSED,
    REPEATED,
    THROTTLE,
)
from tests.groundstation.ui.examples import snapshot
from tests.groundstation.ui.pilots import Console, console
from tests.waits import until

GOLDEN = Path(__file__).parents[1] / "golden"
SMALL, WIDE = (80, 24), (140, 45)
REFUSAL = LogGroup(MODE, REFUSED, (REASON,))


@pytest.mark.parametrize("line", [MODE, REFUSED, REASON])
def test_a_request_its_answer_and_the_vehicles_words_are_joined(line: LogLine) -> None:
    assert find_group(LINES, line) == REFUSAL
    assert REFUSAL.numbers == {MODE.number, REFUSED.number, REASON.number}


@pytest.mark.parametrize("line", [FOUND, REPEATED, OTHERS, BACK])
def test_other_lines_stand_alone(line: LogLine) -> None:
    assert find_group(LINES, line) == LogGroup()


def test_an_accepted_command_is_joined_too() -> None:
    assert find_group(LINES, ARM) == LogGroup(ARM, ARMED, (THROTTLE,))


def test_an_answer_excludes_distant_texts_and_old_requests() -> None:
    late = replace(REASON, time=REFUSED.time + 1.1)
    assert find_group((MODE, REFUSED, late), REFUSED) == LogGroup(MODE, REFUSED)
    early = replace(MODE, time=REFUSED.time - 15.1)
    assert find_group((early, REFUSED), REFUSED) == LogGroup(None, REFUSED)


def test_disarm_is_no_answer_to_arm() -> None:
    disarm = replace(ARMED, text="disarm accepted")
    assert find_group((ARM, disarm), disarm).request is None


def test_a_typed_line_belongs_to_the_first_answer_after_it() -> None:
    typed = LogLine(time=REFUSED.time - 1.0, severity=6, label="line", text=":goto 1 2", number=1)
    refused = replace(REFUSED, text="DO_REPOSITION denied", number=2)
    assert find_group((typed, refused), typed) == LogGroup(typed, refused)
    between = replace(ARMED, time=refused.time - 0.5, text="Rover 1: speed 1 m/s accepted", number=2)
    refused = replace(refused, number=3)
    assert find_group((typed, between, refused), refused).request is None


def test_the_detail_has_everything_of_a_refusal() -> None:
    rows = {row.name: row.text for row in describe(REASON, REFUSAL).rows}
    assert rows == {
        "text": REASON.text,
        "time": "2023-11-14 22:14:12.5",
        "source": "1/1 ArduPilot rover 1",
        "severity": "CRITICAL (2): act at once: a primary system fails",
        "request": "22:14:12.3 mode GUIDED",
        "answer": "22:14:12.4 mode GUIDED failed",
        "after": "0.10 s",
        "result": "FAILED (4): valid, but it failed: put the reason right first",
    }


def test_repeats_have_their_number_and_times() -> None:
    rows = {row.name: row.text for row in describe(REPEATED, LogGroup()).rows}
    assert rows["repeats"] == "×3, 22:13:32.5 to 22:13:40.0"


def test_the_names_are_those_of_the_dialect() -> None:
    assert list(range(len(RESULTS))) == list(Result)
    assert [name for name, _ in RESULTS] == [result_token(each) for each in Result]
    assert list(SEVERITY_NAMES) == [each.name for each in Severity]
    assert len(SEVERITY_MEANINGS) == len(Severity)


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (2, "DENIED (2): a parameter is wrong"),
        (6, "CANCELLED (6): cancelled"),
        (10, "NOT_IN_CONTROL (10): valid"),
        (99, "a result without a name (99)"),
    ],
)
def test_each_result_has_a_name_and_a_meaning(number: int, text: str) -> None:
    assert text in result_text(number)


async def open_refusal(screen: Console) -> None:
    await screen.press("f6")
    screen.station.offer_view(REFUSAL_PAGE)
    await screen.show(snapshot())
    await until(lambda: "battery low" in screen.text)
    await screen.press("up", "up", "up")
    await screen.show(snapshot())
    await until(lambda: "joined" in screen.text)


def compare(name: str, shown: str) -> None:
    file = GOLDEN / f"{name}.txt"
    if os.environ.get("GOLDEN") == "write":
        file.write_text(shown, "utf-8")
    assert shown == file.read_text("utf-8")


async def test_the_small_detail_opens_with_enter_and_escape_goes_back() -> None:
    async with console(SMALL) as screen:
        await open_refusal(screen)
        assert "FAILED (4)" not in screen.text
        await screen.press("enter")
        await screen.show(snapshot())
        await until(lambda: "FAILED (4)" in screen.text)
        compare("log_detail_80x24", screen.text)
        await screen.press("e")
        await until(lambda: "4 of 10 lines" in screen.text)
        await screen.press("escape")
        await until(lambda: "10 lines" in screen.text and "of 10" not in screen.text)
        await screen.press("escape")
        await until(lambda: "FAILED (4)" not in screen.text)
        await screen.press("escape")
        await until(lambda: screen.app.screen is screen.app.drive)


@pytest.mark.parametrize("ascii", [False, True])
async def test_the_detail_of_a_wide_terminal_is_always_there(*, ascii: bool) -> None:  # noqa: A002
    async with console(WIDE, look=Look(ascii=ascii)) as screen:
        await open_refusal(screen)
        compare("ascii_log_detail_140x45" if ascii else "log_detail_140x45", screen.text)
