"""Explanations of equivalent mutants (survivors.toml): load them, and find missing and stale ones."""

from __future__ import annotations

import tomllib
from collections import defaultdict
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import NamedTuple

from tests.mutation.mutants import Mutant, build_mutants

FILE = Path(__file__).with_name("survivors.toml")


class Key(NamedTuple):
    """Identity of a mutant that does not change with edits of other lines."""

    path: str
    function: str
    text: str

    def __str__(self) -> str:
        return f"{self.path}: {self.function or 'module'}: {self.text}"


def key(mutant: Mutant) -> Key:
    """Return the key of `mutant`."""
    return Key(mutant.path, mutant.function, mutant.text)


def load_explanations(file: Path = FILE) -> dict[Key, str]:
    """Read the file: tables of mutants of a function with the reason why no test can kill them."""
    groups = tomllib.loads(file.read_text()).get("survivors", [])
    return {
        Key(group["module"], group["function"], text): group["why"] for group in groups for text in group["mutants"]
    }


def unexplained_and_stale(
    mutants: Sequence[Mutant], survivors: Sequence[Mutant], explanations: Collection[Key]
) -> tuple[list[Mutant], list[Key]]:
    """Return survivors without an explanation, and explanations in the modules of `mutants` without a survivor."""
    survived = {key(mutant) for mutant in survivors}
    modules = {mutant.path for mutant in mutants}
    unexplained = [mutant for mutant in survivors if key(mutant) not in explanations]
    return unexplained, [each for each in explanations if each.path in modules and each not in survived]


def find_gone(explanations: Collection[Key]) -> list[Key]:
    """Return the explanations whose mutant is not in the source: that has changed since."""
    functions = defaultdict(set)
    for each in explanations:
        functions[each.path].add(each.function)
    known = {
        key(mutant) for path, names in functions.items() if Path(path).exists() for mutant in build_mutants(path, names)
    }
    return [each for each in explanations if each not in known]
