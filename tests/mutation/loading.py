"""Replace loaded code by a mutant: one function, or a whole module."""

from __future__ import annotations

import gc
import importlib.abc
import importlib.machinery
import importlib.util
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from types import CodeType, FunctionType, ModuleType

from tests.mutation.mutants import Mutant

FRESH = ("vehicle", "link", "groundstation", "tests.")
"""Prefixes of the modules that are imported anew with a changed module, because they may import it."""

Functions = Mapping[tuple[str, str], list[FunctionType]]
"""File and qualified name -> functions."""


def find_functions() -> Functions:
    """Return all loaded functions, including those held by properties and tables."""
    gc.unfreeze()  # tests/conftest.py freezes what is collected, and frozen objects are not listed
    found: defaultdict[tuple[str, str], list[FunctionType]] = defaultdict(list)
    for each in gc.get_objects():
        if isinstance(each, FunctionType):
            found[each.__code__.co_filename, each.__code__.co_qualname].append(each)
    return found


def replace_function(mutant: Mutant, functions: Functions) -> bool:
    """Replace the code of the function that `mutant` changes. Raises LookupError if it is not loaded.

    Returns False, and replaces nothing, where a function cannot take the code because it uses other variables of the
    functions around it: one without its only `super()` has no `__class__`.
    """
    changed = {(code.co_qualname, code.co_firstlineno): code for code in _codes(mutant.compile())}
    loaded = functions.get((mutant.file, mutant.function))
    if not loaded:
        raise LookupError(mutant.function)
    codes = [changed[mutant.function, function.__code__.co_firstlineno] for function in loaded]
    if any(f.__code__.co_freevars != code.co_freevars for f, code in zip(loaded, codes, strict=True)):
        return False
    for function, code in zip(loaded, codes, strict=True):
        function.__code__ = code
    return True


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


def replace_module(mutant: Mutant) -> None:
    """Make the next import load the changed module, and load anew all modules that may import it."""
    for name in [name for name in sys.modules if name.startswith(FRESH) and not name.startswith("tests.mutation")]:
        del sys.modules[name]
    sys.meta_path.insert(0, MutantFinder(mutant))


class MutantFinder(importlib.abc.MetaPathFinder):
    """Finds the changed module in place of the one on disk."""

    def __init__(self, mutant: Mutant) -> None:
        self._mutant = mutant

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return the spec of the changed module; None for all others."""
        if fullname != self._mutant.module:
            return None
        file = self._mutant.file
        return importlib.util.spec_from_file_location(fullname, file, loader=_Loader(self._mutant, file))


class _Loader(importlib.machinery.SourceFileLoader):
    def __init__(self, mutant: Mutant, file: str) -> None:
        super().__init__(mutant.module, file)
        self._code = mutant.compile()

    def get_code(self, fullname: str) -> CodeType:
        return self._code
