"""Lines of the screens: which verbs they run, and one line for every mistake."""

from __future__ import annotations

import pytest

from dialects.enums import Autopilot, VehicleType
from dialects.kinds import find_kind
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.common.exit_codes import VerbError
from groundstation.verbs.line.overrides import OVERRIDES
from groundstation.verbs.line.parser import parse_line
from groundstation.verbs.line.words import complete
from groundstation.verbs.table import VERBS


def test_every_override_is_of_a_verb_that_a_line_runs() -> None:
    actions = ((f"{verb} {name}".strip(), each) for verb, row in VERBS.items() for name, each in row.actions.items())
    assert set(OVERRIDES) <= {name for name, action in actions if not action.line.elsewhere}


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "write a verb; TAB lists them"),
        ("mode 'HOLD", "No closing quotation"),
        ("mode", "mode: the following arguments are required: MODE"),
        ("mode HOLD now", "mode: unrecognized arguments: now"),
        ("moed HOLD", "'moed' is neither a verb nor an endpoint: did you mean `:mode`?"),
        ("!ls", "'!ls' is not a verb; TAB lists them"),
        ("mode --help", "mode [-h]"),
        ("param", "param: the following arguments are required: ACTION"),
        ("param set FS_TIMEOUT x", "param set: argument VALUE: 'x' is not a number"),
        ("rate NOTHING 1", "NOTHING"),
        ("command DO_SET_HOEM", "there is no command 'DO_SET_HOEM'"),
        ("goto 95 0", "95 0 is not a latitude and longitude"),
        ("mode HOLD -e udpin:127.0.0.1:14550", "mode: a line uses the links and the dialect of this ground station"),
        ("arm", "arm: is a key that is held for 1 s on Drive, so that no text does it: r"),
        ("drive --throttle 30 --for 2", "drive: the keys of the Drive screen (F1) drive"),
        ("mission put x.plan", "mission put: use the Map screen (F2)"),
        ("param load a.param", "param load: use the Params screen (F4)"),
        ("watch ATTITUDE", "watch: use the Messages screen (F3)"),
        ("wp list", "wp list: use `:mission show`"),
        ("rc 3 1600", "rc: refused: a vehicle may hold an override for seconds"),
        ("param fetch", "param fetch: use `:param get`"),
        ("module load map", "module: there are no modules"),
    ],
)
def test_a_mistake_is_one_line(text: str, error: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(VerbError) as raised:
        parse_line(text)
    assert error in str(raised.value)
    assert "\n" not in str(raised.value)
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("text", "name", "mode"),
    [("RTL", "mode", "RTL"), ("rtl", "mode", "rtl"), ("auto", "mode", "auto"), ("home", "home", None)],
)
def test_the_name_of_a_mode_alone_chooses_it(text: str, name: str, mode: str | None) -> None:
    parsed = parse_line(text, {"AUTO", "RTL", "HOLD"})
    assert parsed.name == name
    assert getattr(parsed.options, "name", None) == mode


def test_rtl_goes_home_where_no_mode_has_that_name() -> None:
    assert parse_line("rtl", {"AUTO_RTL"}).name == "home"


@pytest.mark.parametrize(
    ("text", "asks"),
    [
        ("mode HOLD", False), ("mode manual", False), ("mode AUTO", True), ("mode 17", True), ("disarm", False),
        ("stop", False), ("estop", False), ("speed 1", False), ("goto --by 1 1", True), ("home", True),
        ("mission start", True), ("mission pause", False), ("mission jump 3", True), ("fence on", False),
        ("fence off", True), ("command DO_SET_HOME 1", True), ("reboot", True), ("param set A 1", True),
    ],
)  # fmt: skip
def test_what_asks_first(text: str, asks: bool) -> None:
    parsed = parse_line(text)
    rover = VehicleState(1, 1)
    rover.model = find_kind(Autopilot.GENERIC, VehicleType.GROUND_ROVER)
    assert parsed.action.line.asks(parsed.options, rover) is asks


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mo", ("modes", "mode")),
        ("mission s", ("show", "start")),
        ("mode HO", ("HOLD",)),
        ("command DO_SET_HO", ("DO_SET_HOME",)),
        ("rate VFR", ("VFR_HUD",)),
        ("goto --b", ("--by",)),
        ("control ", ("show", "request", "release")),
        ("nothing x", ()),
    ],
)
def test_completion(text: str, words: tuple[str, ...]) -> None:
    assert complete(text, None) == words
    assert "drive" not in complete("", None)
