"""Why mutants survive that no test can kill: survivors.toml, and what in it is missing or stale."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import NamedTuple

from tests.mutation.mutants import Mutant

FILE = Path(__file__).with_name("survivors.toml")


class Key(NamedTuple):
    """Names a mutant in a way that outlives edits of other lines."""

    path: str
    function: str
    text: str

    def __str__(self) -> str:
        return f"{self.path}: {self.function or 'module'}: {self.text}"


def key(mutant: Mutant) -> Key:
    """Return the key of `mutant`."""
    return Key(mutant.path, mutant.function, mutant.text)


def load_explanations(file: Path = FILE) -> dict[Key, str]:
    """Read the file: for each function of each module a table of mutants and the reason why they cannot be seen."""
    groups = tomllib.loads(file.read_text()).get("survivors", [])
    return {
        Key(group["module"], group["function"], text): group["why"] for group in groups for text in group["mutants"]
    }


def unexplained_and_stale(
    mutants: Sequence[Mutant], survivors: Sequence[Mutant], explanations: Collection[Key]
) -> tuple[list[Mutant], list[Key]]:
    """Return the survivors without an explanation, and the explanations of a module that was run without a survivor."""
    survived = {key(mutant) for mutant in survivors}
    modules = {mutant.path for mutant in mutants}
    unexplained = [mutant for mutant in survivors if key(mutant) not in explanations]
    return unexplained, [each for each in explanations if each.path in modules and each not in survived]
