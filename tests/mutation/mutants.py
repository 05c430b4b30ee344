"""Mutants of a module: each replaces one node of its syntax tree."""

from __future__ import annotations

import ast
import importlib
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType

from tests.mutation.changes import build_changes

TEXT_MAX = 90
"""Length up to which the text of a mutant shows the expression or statement around the change."""
NOT_CODE = {"annotation", "returns", "decorator_list", "type_params", "bases"}
"""Fields of syntax nodes that are not mutated."""


@dataclass(frozen=True, slots=True)
class Spot:
    """A place in a syntax tree: a field of a node, or an entry of a field that is a list."""

    parents: tuple[ast.AST, ...]
    """From the module to the node that holds the field."""
    field: str
    index: int | None
    function: str

    @property
    def node(self) -> ast.AST:
        """Node at this place."""
        value = getattr(self.parents[-1], self.field)
        found: ast.AST = value if self.index is None else value[self.index]
        return found

    def put(self, node: ast.AST) -> None:
        """Replace the node at this place."""
        if self.index is None:
            setattr(self.parents[-1], self.field, node)
        else:
            getattr(self.parents[-1], self.field)[self.index] = node

    @property
    def statement(self) -> ast.AST:
        """Innermost simple statement, or part of a compound statement, that contains this place."""
        chain = [*self.parents, self.node]
        innermost = max(at for at, node in enumerate(chain) if isinstance(node, ast.stmt | ast.Module))
        return chain[innermost] if not hasattr(chain[innermost], "body") else chain[min(innermost + 1, len(chain) - 1)]

    def describe(self, changed: ast.AST) -> str:
        """Return the source before and after the change, with the code around it where that is short."""
        shown = self.node
        for parent in reversed(self.parents):
            if not _is_part_of_line(parent) or len(ast.unparse(parent)) > TEXT_MAX:
                break
            shown = parent
        before = ast.unparse(shown)
        if shown is self.node:
            return f"{before} -> {ast.unparse(changed)}"
        original = self.node
        self.put(changed)
        after = ast.unparse(shown)
        self.put(original)
        return f"{before} -> {after}"


@dataclass(frozen=True, slots=True)
class Mutant:
    """A module with one node replaced."""

    path: str
    """Path of the module from the root of the repository."""
    text: str
    """Source before and after the change; with a number if the function has the same text more than once."""
    line: int
    lines: range
    """Lines of the statement: the tests that execute one of them run against the mutant."""
    spot: Spot
    changed: ast.AST
    """Node that replaces the one at `spot`."""

    @property
    def module(self) -> str:
        """Name of the module."""
        return module_name(self.path)

    @property
    def function(self) -> str:
        """Qualified name of the outermost function that contains the change; "" at module level."""
        return self.spot.function

    @property
    def file(self) -> str:
        """Absolute path of the module."""
        return str(Path(self.path).resolve())

    def compile(self) -> CodeType:
        """Return the code of the changed module."""
        tree, original = self.spot.parents[0], self.spot.node
        assert isinstance(tree, ast.Module)
        self.spot.put(ast.fix_missing_locations(ast.copy_location(self.changed, original)))
        code = compile(ast.fix_missing_locations(tree), self.file, "exec")
        self.spot.put(original)
        return code


def module_name(path: str) -> str:
    """Return the name of the module at `path`."""
    return path.removesuffix(".py").replace("/", ".")


def _is_part_of_line(node: ast.AST) -> bool:
    return isinstance(node, ast.expr | ast.comprehension | ast.keyword) or (
        isinstance(node, ast.stmt) and not hasattr(node, "body")
    )


def build_mutants(path: str, functions: Collection[str] | None = None) -> list[Mutant]:
    """Return the mutants of the module at `path`; of these functions only, "" for the module level."""
    namespace = vars(importlib.import_module(module_name(path)))
    found, seen = [], Counter[tuple[str, str]]()
    for spot in _spots(ast.parse(Path(path).read_text()), (), ""):
        if functions is not None and spot.function not in functions:
            continue
        for changed in build_changes(spot.node, spot.field, namespace):
            text = spot.describe(changed)
            seen[spot.function, text] += 1
            count = seen[spot.function, text]
            found.append(_mutant(path, spot, changed, text if count == 1 else f"{text} ({count})"))
    return found


def unchanged(path: str) -> Mutant:
    """Return a mutant at module level that changes nothing."""
    tree = ast.parse(Path(path).read_text())
    return _mutant(path, Spot((tree,), "body", 0, ""), tree.body[0], "")


def _mutant(path: str, spot: Spot, changed: ast.AST, text: str) -> Mutant:
    statement = spot.statement
    first, last = getattr(statement, "lineno", 1), getattr(statement, "end_lineno", 1)
    return Mutant(path, text, getattr(spot.node, "lineno", first), range(first, last + 1), spot, changed)


def _spots(node: ast.AST, parents: tuple[ast.AST, ...], function: str) -> Iterator[Spot]:
    inside = (*parents, node)
    for field, value in ast.iter_fields(node):
        if field in NOT_CODE or isinstance(node, ast.JoinedStr) or _is_docstring(node):
            continue
        entries = list(enumerate(value)) if isinstance(value, list) else [(None, value)]
        for index, child in entries:
            if isinstance(child, ast.AST):
                scope = _scope(inside, field) or ""
                yield Spot(inside, field, index, scope)
                yield from _spots(child, inside, scope)


def _scope(parents: tuple[ast.AST, ...], field: str) -> str | None:
    """Return the qualified name of the outermost function whose body is under `parents`."""
    names = []
    for at, node in enumerate(parents):
        if isinstance(node, ast.ClassDef):
            names.append(node.name)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            inner = parents[at + 1] if at + 1 < len(parents) else None
            in_body = field == "body" if inner is None else inner in node.body
            return ".".join([*names, node.name]) if in_body else None
    return None


def _is_docstring(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
