"""The CSS rules of each widget, found once for all apps of a process.

Textual compares each widget of each app with some hundred rules, and sets forty styles one after the other: that took a
quarter of the CPU time of the start of an app.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import pytest
from textual.app import App
from textual.css.styles import RulesMap
from textual.css.stylesheet import Stylesheet
from textual.dom import DOMNode
from textual.widget import Widget

Key = tuple[object, ...]
PLACES = "places"
"""Key of Textual's cache of one pass over nodes, which change no class and no focus meanwhile, for their places."""


class Match(NamedTuple):
    """The rules of a node, and whether one of them is for a node below the mouse."""

    rules: RulesMap | None
    hover: bool


class Matches:
    """Applies stylesheets as Textual does, but looks up what it has found for another node in the same place."""

    def __init__(self) -> None:
        self._apply, self._replace = Stylesheet.apply, Stylesheet.replace_rules
        self._found: dict[Key, Match] = {}
        self._noted: list[RulesMap | None] = []
        """Of the nodes for which Textual itself looks for rules, the outermost first."""
        self._styles: dict[int, RulesMap] = {}
        """Rules of `_found`, by their id -> the styles of a new node with them."""
        self._places: dict[Key, int] = {}
        """All of a node that a selector can ask for, and the place of the one around it -> its place."""
        self._sheets: dict[tuple[int, ...], int] = {}
        """Rules of a stylesheet, which `parsed_css` keeps alive, by their ids -> a number."""

    def apply(self, sheet: Stylesheet, node: DOMNode, *, animate: bool = False, cache: Any = None) -> None:
        """Give a node the rules of a stylesheet."""
        key = self._number(sheet), self._place(node, {} if cache is None else cache.setdefault(PLACES, {}))
        match = self._found.get(key)
        if match is None:
            self._noted.append(None)
            self._apply(sheet, node, animate=animate, cache=cache)
            rules = self._noted.pop()
            if not (node._has_order_style or node._has_odd_or_even or node._has_focus_within):  # others count there
                self._found[key] = Match(rules, node._has_hover_style)
            return
        node._has_hover_style = match.hover
        node._has_order_style = node._has_odd_or_even = node._has_focus_within = False
        if match.rules is not None:
            self._set(node, match.rules, animate)
        sheet._process_component_classes(node)

    def replace_rules(self, node: DOMNode, rules: RulesMap, animate: bool = False) -> None:
        """Note rules that Textual has found, and set them."""
        self._noted[-1] = rules
        self._replace(node, rules, animate=animate)

    def _set(self, node: DOMNode, rules: RulesMap, animate: bool) -> None:
        """Set rules of `_found`: only those that change, and all at once on a new node, which nothing shows yet."""
        base = node.styles.base
        if animate and rules.get("transitions"):
            self._replace(node, rules, animate=True)
        elif animate or base._rules or node._is_mounted:
            old = base._rules
            changed = (
                [] if old == rules else [key for key in old.keys() | rules.keys() if old.get(key) != rules.get(key)]
            )
            for key in changed:
                setattr(base, key, rules.get(key))
            if changed or not animate:
                node.notify_style_update()
        elif id(rules) in self._styles:
            base.merge_rules(self._styles[id(rules)])
            node.notify_style_update()
        else:
            self._replace(node, rules)
            self._styles[id(rules)] = base.get_rules()

    def _place(self, node: Any, known: dict[int, int]) -> int:
        """Return a number for all of a node and of those around it that a selector can ask for, but their order."""
        if not isinstance(node, DOMNode):
            return 0
        place = known.get(id(node))
        if place is None:
            parts: Key = (type(node), node.id, node.classes, node._pseudo_classes_cache_key)
            if isinstance(node, Widget):
                parts += (node.can_focus,)
            elif isinstance(node, App):
                parts += (node.app_focus, node.theme, node.is_inline, node.native_ansi_color, node.no_color)
            parts += (self._place(node._parent, known),)
            place = known[id(node)] = self._places.setdefault(parts, len(self._places) + 1)
        return place

    def _number(self, sheet: Stylesheet) -> int:
        rules = sheet.rules
        known = sheet.__dict__.get("_numbered")
        if known is None or known[0] is not rules:
            known = rules, self._sheets.setdefault(tuple(map(id, rules)), len(self._sheets))
            sheet.__dict__["_numbered"] = known
        return int(known[1])


def share(patch: pytest.MonkeyPatch) -> None:
    """Let all stylesheets share their matches."""
    matches = Matches()

    def apply(sheet: Stylesheet, *arguments: Any, **options: Any) -> None:
        matches.apply(sheet, *arguments, **options)

    patch.setattr(Stylesheet, "apply", apply)
    patch.setattr(Stylesheet, "replace_rules", matches.replace_rules)
