"""Which parameters a screen shows: by words, by group, by what has changed. Several words are alternatives."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from groundstation.formats.param_docs import ParamDocs
from groundstation.views.params import ParamGroup, ParamPageRequest
from link.services.param.client import Param
from link.services.param.float32 import same_float32
from link.services.param.values import NAME_SIZE

MIN_TEXT_WORD = 3
"""Letters of a word from which on it is looked for in the texts, too: shorter ones are in most of them."""


def is_changed(param: Param) -> bool:
    """Return whether a parameter is not at its default; False where that is not known."""
    return param.default is not None and not same_float32(param.value, param.default)


def groups_of(names: Iterable[str]) -> dict[str, str]:
    """Return the group of each name: what stands before its first underline.

    A number at its end counts only where no other number follows the same letters: RC1 and RC2 are RC, EK3 is EK3.
    """
    heads = {name: name.partition("_")[0] for name in names}
    variants: dict[str, set[str]] = {}
    for head in heads.values():
        variants.setdefault(head.rstrip("0123456789") or head, set()).add(head)
    shown = {head: bare if len(all_) > 1 else head for bare, all_ in variants.items() for head in all_}
    return {name: shown[head] for name, head in heads.items()}


def count_groups(params: Mapping[str, Param], groups: Mapping[str, str]) -> tuple[ParamGroup, ...]:
    """Return all groups by name, with how many parameters they have."""
    counts: dict[str, list[int]] = {}
    for name, param in params.items():
        count = counts.setdefault(groups[name], [0, 0])
        count[0] += 1
        count[1] += is_changed(param)
    return tuple(ParamGroup(name, *counts[name]) for name in sorted(counts))


def choose(
    params: Mapping[str, Param], docs: ParamDocs, groups: Mapping[str, str], request: ParamPageRequest
) -> list[Param]:
    """Return the parameters of a request in the order of the table: those whose name matches come first."""
    words = [_Word(word) for word in request.filter.upper().split()]
    wanted = None if request.names is None else set(request.names)
    by_name: list[Param] = []
    by_text: list[Param] = []
    for name, param in sorted(params.items()):
        if request.group and groups[name] != request.group:
            continue
        if (wanted is not None and name not in wanted) or (request.changed_only and not is_changed(param)):
            continue
        if not words or any(word.in_name(name) for word in words):
            by_name.append(param)
        elif any(word.in_text(docs.search_text(name)) for word in words):
            by_text.append(param)
    return by_name + by_text


class _Word:
    """A word of a filter, in capitals. It is in a name as a part of it, or as beginnings of its parts (RCOV)."""

    def __init__(self, word: str) -> None:
        self._word = word
        letters = word.replace("_", "")[:NAME_SIZE]
        jump = r"(?:[^_]*_(?:.*_)?)?"
        self._short = re.compile("(?:^|_)" + jump.join(map(re.escape, letters))) if len(letters) > 1 else None

    def in_name(self, name: str) -> bool:
        upper = name.upper()
        return self._word in upper or bool(self._short and self._short.search(upper))

    def in_text(self, text: str) -> bool:
        """Return whether a word of the text begins with it."""
        return len(self._word) >= MIN_TEXT_WORD and f" {self._word}" in text
