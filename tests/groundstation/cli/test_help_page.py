"""The page of `mavhelm --help`: every verb once, on one screen of a terminal."""

from __future__ import annotations

from groundstation.cli.help_page import GROUPS, WIDTH, build_page
from groundstation.cli.verb_help import LOCAL_HELP, PROGRAM_HELP, VERB_HELP
from groundstation.verbs.action import ONLY
from groundstation.verbs.manual.examples import help_examples
from groundstation.verbs.table import VERBS
from link.endpoint import SCHEMES


def test_every_verb_and_program_is_in_one_group() -> None:
    grouped = [verb for verbs in GROUPS.values() for verb in verbs]
    assert sorted(grouped) == sorted([*VERB_HELP, *LOCAL_HELP, *PROGRAM_HELP])


def test_the_page_fits_in_a_terminal_of_80_by_24() -> None:
    lines = build_page().splitlines()
    assert len(lines) <= 24
    assert max(map(len, lines)) <= WIDTH
    assert all(each.syntax in build_page() for each in SCHEMES.values())


def test_every_verb_and_action_has_an_example() -> None:
    words = [(verb, "" if name == ONLY else name) for verb, actions in VERBS.items() for name in actions]
    words += [(verb, "") for verb in LOCAL_HELP]
    assert [each for each in words if f"mavhelm {' '.join(each).strip()}" not in help_examples(*each)] == []
