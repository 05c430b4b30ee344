"""The CSS of widgets and screens, parsed once for all apps of a process.

Textual parses all of it for each app and again for each screen that it opens: a fifth of the CPU time of a test.
"""

from __future__ import annotations

from typing import Any

import pytest
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet


def share(patch: pytest.MonkeyPatch) -> None:
    """Let a stylesheet take rules that another one has parsed from the same text with the same variables."""
    parsed: dict[tuple[object, ...], list[RuleSet]] = {}
    parse = Stylesheet._parse_rules

    def rules(sheet: Stylesheet, *arguments: Any, **options: Any) -> list[RuleSet]:
        key = (*arguments, *options.items(), *sheet._variables.items())
        if key not in parsed:
            parsed[key] = parse(sheet, *arguments, **options)
        return parsed[key]

    patch.setattr(Stylesheet, "_parse_rules", rules)
