"""Names and texts from the link on the screens: none is taken for markup, whatever widget shows it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from textual.widgets import Static

from groundstation.ui.display.wrap import plain

UI = Path(__file__).parents[3] / "groundstation" / "ui"
TITLES = ("border_title", "border_subtitle")
HOSTILE = ("[/x]", "[/]", "[red]a", "[@click=app.quit]b[/]", "[", "\x1b[2J", "a\x1b]0;b\x07", "a\nb", "[[")


def written_titles() -> Iterator[tuple[str, ast.expr]]:
    """Yield where a title is set, and to what."""
    for path in sorted(UI.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            target = node.targets[0] if isinstance(node, ast.Assign) else None
            if isinstance(node, ast.Assign) and isinstance(target, ast.Attribute) and target.attr in TITLES:
                yield f"{path.relative_to(UI)}:{node.lineno}", node.value


def is_plain(value: ast.expr) -> bool:
    """Return whether an expression is a literal text of ours or a call of plain()."""
    if isinstance(value, ast.Constant):
        return "[" not in str(value.value)
    return isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == "plain"


def test_each_title_of_a_widget_is_plain() -> None:
    found = list(written_titles())
    assert len(found) > 20
    loose = [where for where, value in found if not is_plain(value) and "drive/pane.py" not in where]
    assert loose == [], "a str is markup in a title: plain(...)"


def test_each_static_takes_no_markup() -> None:
    for path in sorted(UI.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Static":
                content = bool(node.args) and isinstance(node.args[0], ast.Call)  # Content.assemble(...)
                assert content or any(each.arg == "markup" for each in node.keywords), f"{path}:{node.lineno}"


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_name_in_a_title_is_shown_as_it_is(name: str) -> None:
    widget = Static(markup=False)
    widget.border_title = plain(name)
    shown = widget.render_str(widget.border_title or "")
    assert str(shown) == plain(name).plain
    assert "\x1b" not in str(shown)
    assert not shown.spans
