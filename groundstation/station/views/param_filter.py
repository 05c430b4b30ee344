"""Which parameters a screen shows: by words, by group, by what has changed. Several words are alternatives."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from groundstation.formats.param_compare import IDENTITY
from groundstation.formats.param_docs import ParamDocs
from groundstation.natural_order import natural_key
from groundstation.views.params import ParamGroup, ParamPageRequest
from link.services.param.client import Param
from link.services.param.values import NAME_SIZE

MIN_TEXT_WORD = 3
"""Letters of a word from which on it is looked for in the texts, too: shorter ones are in most of them."""


def is_changed(param: Param) -> bool:
    """Return whether a parameter is not at its default; False where that is not known, and for the vehicle's id."""
    return param.is_changed and param.name not in IDENTITY


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
    return tuple(ParamGroup(name, *counts[name]) for name in sorted(counts, key=natural_key))


class ParamRanks:
    """How well names match a filter: kept while the filter and the texts stay, because a page is built 4 times/s."""

    def __init__(self) -> None:
        self._filter: tuple[str, int] = ("", 0)
        self._words: list[_Word] = []
        self._ranks: dict[str, int] = {}

    def set_filter(self, text: str, docs: ParamDocs) -> None:
        """Use this filter from now on."""
        if (text, id(docs)) != self._filter:
            self._filter, self._ranks = (text, id(docs)), {}
            self._words = [_Word(word) for word in text.upper().split()]

    def rank(self, name: str, docs: ParamDocs) -> int:
        """Return the best rank of all words."""
        if name not in self._ranks:
            self._ranks[name] = min((word.rank(name, docs) for word in self._words), default=0)
        return self._ranks[name]


def choose(
    params: Mapping[str, Param],
    docs: ParamDocs,
    groups: Mapping[str, str],
    request: ParamPageRequest,
    ranks: ParamRanks,
) -> list[Param]:
    """Return the parameters of a request, the best matches first, else by name."""
    ranks.set_filter(request.filter, docs)
    wanted = None if request.names is None else set(request.names)
    found: tuple[list[Param], ...] = ([], [], [])
    for name in sorted(params, key=natural_key):
        param = params[name]
        if request.group and groups[name] != request.group:
            continue
        if (wanted is not None and name not in wanted) or (request.changed_only and not is_changed(param)):
            continue
        rank = ranks.rank(name, docs)
        if rank < len(found):
            found[rank].append(param)
    return [param for each in found for param in each]


class _Word:
    """A word of a filter, in capitals."""

    def __init__(self, word: str) -> None:
        self._word = word
        letters = word.replace("_", "")[:NAME_SIZE]
        jump = r"(?:[^_]*_(?:.*_)?)?"
        self._short = re.compile("(?:^|_)" + jump.join(map(re.escape, letters))) if len(letters) > 1 else None

    def rank(self, name: str, docs: ParamDocs) -> int:
        """Return 0 for a part of a name, 1 for the beginnings of its parts (RCOV), 2 for a text, 3 for no match."""
        upper = name.upper()
        if self._word in upper:
            return 0
        if self._short and self._short.search(upper):
            return 1
        return 2 if len(self._word) >= MIN_TEXT_WORD and f" {self._word}" in docs.search_text(name) else 3
