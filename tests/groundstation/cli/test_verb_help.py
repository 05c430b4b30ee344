"""The verbs of --help are those that exist."""

from __future__ import annotations

from groundstation.cli.verb_help import VERB_HELP, verb_help
from groundstation.verbs.table import VERBS


def test_help_names_every_verb_and_its_actions() -> None:
    assert list(VERB_HELP) == list(VERBS)
    for verb, actions in VERBS.items():
        assert f"mavhelm {verb} " in verb_help()
        assert all(action in VERB_HELP[verb] for action in actions)
