"""The page of `mavhelm --help`: every verb once, on one screen of a terminal."""

from __future__ import annotations

from groundstation.cli.help_page import WIDTH, build_page
from groundstation.cli.verb_help import EVERY_VERB, LOCAL_VERBS, group_verbs, local_examples
from groundstation.verbs.table import VERBS
from link.endpoint import SCHEMES


def test_every_verb_and_program_is_in_one_group() -> None:
    grouped = [verb for _, verbs in group_verbs() for verb in verbs]
    assert sorted(grouped) == sorted(EVERY_VERB)
    assert all(f" {verb}" in build_page() for verb in EVERY_VERB)


def test_the_page_fits_in_a_terminal_of_80_by_24() -> None:
    lines = build_page().splitlines()
    assert len(lines) <= 24
    assert max(map(len, lines)) <= WIDTH
    assert all(each.syntax in build_page() for each in SCHEMES.values())


def test_every_verb_and_action_has_an_example() -> None:
    words = [f"{verb} {action}".strip() for verb, row in VERBS.items() for action in row.actions]
    shown = {each.command for row in EVERY_VERB.values() for each in row.examples}
    assert [each for each in words if not any(command.startswith(f"mavhelm {each}") for command in shown)] == []
    assert all(f"mavhelm {verb}" in local_examples(verb) for verb in LOCAL_VERBS)
