"""The verbs of --help are those that exist."""

from __future__ import annotations

from groundstation.cli.verb_help import verb_help
from groundstation.verbs.table import VERBS


def test_help_names_every_verb_and_its_actions() -> None:
    for verb, row in VERBS.items():
        assert f"mavhelm {verb} " in verb_help()
        assert all(action in row.help for action in row.actions)
