"""Which parameters are shown: words that are alternatives, groups, what has changed."""

from __future__ import annotations

from groundstation.formats.param_docs import ParamDocs
from groundstation.station.views.param_filter import ParamRanks, choose, count_groups, groups_of
from groundstation.views.params import ParamDoc, ParamGroup, ParamPageRequest
from link.services.param.client import Param

NAMES = (
    "FS_ACTION", "FS_GCS_ENABLE", "RC1_MIN", "RC2_MIN", "RC_OVERRIDE_TIME", "SERVO1_FUNCTION", "EK3_ENABLE", "WP_SPEED",
    "SYSID", "A\\xff_B",
)  # fmt: skip
PARAMS = {name: Param(name, 1.0, 9, None, 0.0 if name.startswith("FS") else None) for name in NAMES}
DOCS = ParamDocs(
    "x", {"WP_SPEED": ParamDoc("WP_SPEED", "Waypoint speed"), "RC1_MIN": ParamDoc("RC1_MIN", text="Failsafe or so")}
)
RANKS = ParamRanks()
"""One for all tests, as a station has one for all filters."""


def chosen(request: ParamPageRequest) -> list[str]:
    return [param.name for param in choose(PARAMS, DOCS, groups_of(PARAMS), request, RANKS)]


def test_several_words_are_alternatives() -> None:
    assert chosen(ParamPageRequest("fs_ rc_over")) == ["FS_ACTION", "FS_GCS_ENABLE", "RC_OVERRIDE_TIME"]


def test_a_word_may_be_the_beginnings_of_the_parts_of_a_name() -> None:
    assert chosen(ParamPageRequest("rcov")) == ["RC_OVERRIDE_TIME"]
    assert chosen(ParamPageRequest("fsge")) == ["FS_GCS_ENABLE"]
    assert chosen(ParamPageRequest("servo_fun")) == ["SERVO1_FUNCTION"]
    assert chosen(ParamPageRequest("wpd")) == [], "the middle of a part is not a beginning"


def test_names_come_before_texts() -> None:
    assert chosen(ParamPageRequest("speed fail")) == ["WP_SPEED", "RC1_MIN"]
    assert chosen(ParamPageRequest("or")) == [], "a short word is looked for in names only"


def test_characters_of_patterns_are_plain() -> None:
    assert chosen(ParamPageRequest("( [a \\xff")) == ["A\\xff_B"]


def test_groups() -> None:
    groups = count_groups(PARAMS, groups_of(PARAMS))
    assert groups[0] == ParamGroup("A\\xff", 1, 0)
    assert groups[1:] == (
        ParamGroup("EK3", 1, 0), ParamGroup("FS", 2, 2), ParamGroup("RC", 3, 0), ParamGroup("SERVO1", 1, 0),
        ParamGroup("SYSID", 1, 0), ParamGroup("WP", 1, 0),
    )  # fmt: skip
    assert chosen(ParamPageRequest(group="RC")) == ["RC1_MIN", "RC2_MIN", "RC_OVERRIDE_TIME"]


def test_changed_and_named_ones() -> None:
    assert chosen(ParamPageRequest(changed_only=True)) == ["FS_ACTION", "FS_GCS_ENABLE"]
    assert chosen(ParamPageRequest(names=("WP_SPEED", "NO_SUCH"))) == ["WP_SPEED"]
    assert chosen(ParamPageRequest(names=())) == []
