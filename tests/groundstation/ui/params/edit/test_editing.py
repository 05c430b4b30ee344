"""Values while they are typed: numbers, names, bits, ranges; changes with undo and redo."""

from __future__ import annotations

import math

import pytest

from groundstation.ui.params.edit.checks import Level, check_value, meaning_of, needs_care, parse_number
from groundstation.ui.params.edit.editor import ValueEditor
from groundstation.ui.params.edit.pending import MAX_UNDO, PendingChange, PendingChanges
from groundstation.ui.params.edit.reasons import REASONS, reason_for
from groundstation.ui.params.scope import group_of
from groundstation.ui.params.status import question_text, written_text
from groundstation.views.params import ParamInfo
from groundstation.views.requests import RequestLine
from tests.groundstation.ui.example_params import INFOS, PAGE, ROWS

ACTION, ENABLE, OPTIONS, TIME = INFOS
BY_NAME = {row.name: row for row in ROWS}


def editor(info: ParamInfo) -> ValueEditor:
    return ValueEditor(BY_NAME[info.name], info.value, info)


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("0x10", "INT32", 16.0), ("-0x1", "INT8", -1.0), ("1e3", "INT16", 1000.0),
        ("0.123456789", "REAL32", 0.12345679),
        ("0.1", "REAL32", 0.1), ("-1", "UINT8", "A is UINT8: 0 to 255"), ("200", "INT8", "A is INT8: -128 to 127"),
        ("1.5", "INT8", "A is INT8: whole numbers only"), ("nan", "REAL32", "'nan' cannot be set"),
        ("inf", "REAL32", "'inf' cannot be set"), ("1e39", "REAL32", "'1e39' cannot be set"),
        ("x", "REAL32", "'x' is not a number"), ("", "REAL32", "'' is not a number"),
        ("0x", "INT8", "'0x' is not a number"), ("9" * 400, "INT32", f"'{'9' * 400}' cannot be set"),
    ],
)  # fmt: skip
def test_numbers(text: str, kind: str, value: float | str) -> None:
    assert parse_number(text, "A", kind) == value


def test_a_value_by_its_name() -> None:
    typed = editor(ACTION)
    assert (typed.text, typed.cursor, len(typed.choices)) == ("2", 2, 7)
    typed.type("smhold")
    assert [name for _, name in typed.choices] == ["SmartRTL or Hold"]
    assert typed.result() == 4.0
    typed.type("rtl")
    assert [name for _, name in typed.choices] == ["RTL", "SmartRTL or RTL", "SmartRTL or Hold"]
    typed.move(1)
    assert typed.result() == 3.0
    typed.type("nothing like it")
    assert typed.result() == "'nothing like it' is neither a number nor a name of its list"
    typed.type("9")
    assert typed.result() == 9.0, "a list may be incomplete"


def test_arrows_choose_a_value_of_the_list() -> None:
    typed = editor(ACTION)
    typed.move(2)
    assert (typed.text, typed.result()) == ("4", 4.0)
    typed.move(-100)
    assert typed.result() == 0.0


def test_bits_are_toggled() -> None:
    typed = editor(OPTIONS)
    typed.move(1)
    typed.toggle()
    assert typed.result() == 3.0
    typed.move(-5)
    typed.toggle()
    assert (typed.text, typed.result()) == ("2", 2.0)
    for text in ("x", "inf", "nan", "0.5"):
        typed.type(text)
        typed.toggle()
        assert typed.text == text, "bits of no whole number"


def test_texts_that_arrive_later() -> None:
    typed = ValueEditor(BY_NAME["FS_ACTION"], 2.0, None)
    assert (typed.choices, typed.bits) == ([], ())
    typed.toggle()
    typed.move(1)
    assert typed.result() == 2.0
    typed.set_info(ACTION)
    assert typed.cursor == 2


@pytest.mark.parametrize(
    ("info", "value", "level", "text"),
    [
        (TIME, 0.5, Level.GOOD, "in range 0 … 120"), (TIME, -1.0, Level.WARNING, "outside 0 … 120"),
        (TIME, 120.0, Level.GOOD, "in range 0 … 120"), (ACTION, 4.0, Level.GOOD, "in its list"),
        (ACTION, 9.0, Level.WARNING, "not in its list"), (OPTIONS, 3.0, Level.GOOD, "known bits"),
        (OPTIONS, 4.0, Level.WARNING, "unknown bits"), (OPTIONS, -1.0, Level.GOOD, "known bits"),
        (None, 1.0, Level.UNKNOWN, ""), (ParamInfo("A", value=0.0, kind="INT8"), 1.0, Level.UNKNOWN, "no range known"),
        (ParamInfo("A", value=0.0, kind="INT8", read_only=True), 1.0, Level.WARNING, "read-only"),
        (ParamInfo("A", value=0.0, kind="REAL32", high=0.1), 0.1, Level.GOOD, "in range -- … 0.1"),
    ],
)  # fmt: skip
def test_checks(info: ParamInfo | None, value: float, level: Level, text: str) -> None:
    found = check_value(info, value)
    assert (found.level, f"{found.text} {found.limits}".strip()) == (level, text)
    assert found.fitted(4) == f"{found.text} {level.value}".strip(), "a range is never cut"


def test_meanings() -> None:
    assert meaning_of(ACTION, 4.0) == "SmartRTL or Hold"
    assert meaning_of(OPTIONS, 3.0) == "Failsafe enabled in Hold mode, Ignore in manual"
    assert meaning_of(OPTIONS, math.nan) == meaning_of(OPTIONS, math.inf) == ""
    assert check_value(OPTIONS, math.inf).level is Level.WARNING
    assert meaning_of(OPTIONS, 0.5) == meaning_of(None, 1.0) == meaning_of(TIME, 3.0) == ""


def test_what_needs_care_while_armed() -> None:
    assert needs_care(None, "FS_ACTION")
    assert needs_care(None, "MOT_THR_MAX")
    assert not needs_care(None, "LOG_BITMASK")
    assert needs_care(ParamInfo("LOG_X", value=0.0, kind="INT8", not_armed=True), "LOG_X")
    changes = {name: PendingChange(name, 0.0, 1.0) for name in ("LOG_X", "FS_ACTION")}
    assert question_text(changes, {}, armed=True) == "write 2 changes to the vehicle, which is ARMED (care: FS_ACTION)"
    assert question_text(changes, {}, armed=False) == "write 2 changes to the vehicle"


def test_each_reason_is_there_once() -> None:
    assert len({name for name, _ in REASONS}) == len(REASONS) >= 20
    assert "0.5 s is enough" in reason_for("RC_OVERRIDE_TIME")
    assert reason_for("LOG_BITMASK") == ""


def test_what_a_refusal_leaves() -> None:
    line = RequestLine(1, "refused", "set 3 parameters", "B: read-only (1 of 3 set)", 1, 3)
    assert written_text(line, ["A"], ["B", "C"]) == "refused: B: read-only (1 of 3 set) · set: A · not tried: C"
    names = [f"P{number}" for number in range(7)]
    assert written_text(line, names[:6], names[6:]).endswith("set: P0, P1, P2, P3 and 2 more")


def test_undo_and_redo() -> None:
    changes = PendingChanges()
    changes.set([PendingChange("A", 1.0, 2.0), PendingChange("B", 1.0, 1.0)])
    assert list(changes.by_name) == ["A"], "the value that it has is not a change"
    changes.set([PendingChange("A", 1.0, 3.0)])
    assert changes.drop("A")
    assert not changes.drop("A")
    assert [changes.undo(), changes.undo(), changes.redo()] == [True, True, True]
    assert changes.by_name["A"].value == 3.0
    changes.set([PendingChange("C", 0.0, 1.0)])
    assert not changes.redo(), "a new step ends what could be done again"


def test_undo_is_bounded() -> None:
    changes = PendingChanges()
    for value in range(MAX_UNDO + 50):
        changes.set([PendingChange("A", -1.0, float(value))])
    assert sum(iter(changes.undo, False)) == MAX_UNDO


def test_what_was_written_is_pending_again_after_undo() -> None:
    changes = PendingChanges()
    changes.set([PendingChange("A", 1.0, 2.0), PendingChange("B", 1.0, 2.0)])
    changes.take_written([changes.by_name["A"]])
    assert list(changes.by_name) == ["B"]
    assert changes.undo()
    assert changes.by_name["A"] == PendingChange("A", 2.0, 1.0)
    assert changes.by_name["B"].value == 2.0, "what was refused stays"


def test_groups_of_names() -> None:
    assert [group_of(name, PAGE) for name in ("RC1_MIN", "SERVO12_TRIM", "FS_ACTION")] == ["RC", "SERVO", "FS"]
