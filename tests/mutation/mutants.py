"""Mutants of one module: its syntax tree with one spot changed."""

from __future__ import annotations

import ast
import copy
import importlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum, EnumType
from pathlib import Path
from types import CodeType

TEXT_MAX = 90
"""Characters of source that a mutant's text shows of its surroundings, where they are so short."""
IGNORED_ENUMS = ("Severity",)
"""What a text's severity does is tested where it is shown."""
NOT_CODE = {"annotation", "returns", "decorator_list", "type_params", "bases"}
"""Fields of syntax nodes that are not mutated."""

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
ORDER = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Mod: ast.Mult, ast.Pow: ast.Mult,
    ast.BitOr: ast.BitAnd, ast.BitAnd: ast.BitOr, ast.FloorDiv: ast.Mult,
}  # fmt: skip
CALLS = {"max": "min", "min": "max", "any": "all", "all": "any"}

Namespace = Mapping[str, object]


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
        """What is there."""
        value = getattr(self.parents[-1], self.field)
        found: ast.AST = value if self.index is None else value[self.index]
        return found

    def put(self, node: ast.AST) -> None:
        """Replace what is there."""
        if self.index is None:
            setattr(self.parents[-1], self.field, node)
        else:
            getattr(self.parents[-1], self.field)[self.index] = node

    @property
    def statement(self) -> ast.AST:
        """The innermost simple statement, or the part of a compound one, that this is in."""
        chain = [*self.parents, self.node]
        innermost = max(at for at, node in enumerate(chain) if isinstance(node, ast.stmt | ast.Module))
        return chain[innermost] if not hasattr(chain[innermost], "body") else chain[min(innermost + 1, len(chain) - 1)]

    def describe(self, changed: ast.AST) -> str:
        """Return the source before and after, with as much of the surroundings as is short."""
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
    """One change of one module."""

    path: str
    """Of the module, from the root of the repository."""
    text: str
    """Source before and after; with a number where the same function has the same text more than once."""
    line: int
    lines: range
    """Of the statement."""
    spot: Spot
    changed: ast.AST
    """What stands at `spot` instead."""

    @property
    def module(self) -> str:
        """Name of the module."""
        return module_name(self.path)

    @property
    def function(self) -> str:
        """Qualified name of the outermost function that the change is in; "" at module level."""
        return self.spot.function

    def compile(self) -> CodeType:
        """Return the code of the changed module."""
        tree, original = self.spot.parents[0], self.spot.node
        assert isinstance(tree, ast.Module)
        self.spot.put(ast.fix_missing_locations(ast.copy_location(self.changed, original)))
        code = compile(ast.fix_missing_locations(tree), str(Path(self.path).resolve()), "exec")
        self.spot.put(original)
        return code


def module_name(path: str) -> str:
    """Return the name of the module at `path`."""
    return path.removesuffix(".py").replace("/", ".")


def _is_part_of_line(node: ast.AST) -> bool:
    return isinstance(node, ast.expr | ast.comprehension | ast.keyword) or (
        isinstance(node, ast.stmt) and not hasattr(node, "body")
    )


def build_mutants(path: str) -> list[Mutant]:
    """Return all mutants of the module at `path`."""
    namespace = vars(importlib.import_module(module_name(path)))
    found, seen = [], Counter[tuple[str, str]]()
    for spot in _spots(ast.parse(Path(path).read_text()), (), ""):
        for changed in _changes(spot, namespace):
            text = spot.describe(changed)
            seen[spot.function, text] += 1
            count = seen[spot.function, text]
            found.append(_mutant(path, spot, changed, text if count == 1 else f"{text} ({count})"))
    return found


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
        if isinstance(node, ast.FunctionDef):
            inner = parents[at + 1] if at + 1 < len(parents) else None
            in_body = field == "body" if inner is None else inner in node.body
            return ".".join([*names, node.name]) if in_body else None
    return None


def _is_docstring(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def _changes(spot: Spot, namespace: Namespace) -> Iterator[ast.AST]:
    """Yield what may stand at `spot`."""
    node = spot.node
    if spot.field == "test" and not isinstance(node, ast.UnaryOp | ast.Compare):
        yield ast.UnaryOp(ast.Not(), node)  # type: ignore[arg-type]
    yield from _enum_members(node, namespace)
    for kind, change in CHANGES.items():
        if isinstance(node, kind):
            yield from change(node)


def _with(node: ast.AST, **fields: object) -> ast.AST:
    changed = copy.copy(node)
    for name, value in fields.items():
        setattr(changed, name, value)
    return changed


def _compare(node: ast.Compare) -> Iterator[ast.AST]:
    for at, operator in enumerate(node.ops):
        yield _with(node, ops=[*node.ops[:at], COMPARISONS[type(operator)](), *node.ops[at + 1 :]])
    if any(isinstance(operator, ORDER) for operator in node.ops):  # of the others the changed operator is the opposite
        yield ast.UnaryOp(ast.Not(), node)


def _boolean(node: ast.BoolOp) -> Iterator[ast.AST]:
    yield _with(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
    for at in range(len(node.values)):
        rest = [*node.values[:at], *node.values[at + 1 :]]
        yield rest[0] if len(rest) == 1 else _with(node, values=rest)


def _unary(node: ast.UnaryOp) -> Iterator[ast.AST]:
    yield node.operand


def _binary(node: ast.BinOp) -> Iterator[ast.AST]:
    yield _with(node, op=OPERATORS[type(node.op)]())


def _augmented(node: ast.AugAssign) -> Iterator[ast.AST]:
    yield _with(node, op=OPERATORS[type(node.op)]())
    yield ast.copy_location(ast.Assign([node.target], node.value), node)


def _constant(node: ast.Constant) -> Iterator[ast.AST]:
    value = node.value
    if isinstance(value, bool):
        yield _with(node, value=not value)
    elif isinstance(value, int):
        yield from (_with(node, value=value + step) for step in (1, -1))
    elif isinstance(value, float):
        yield from (_with(node, value=each) for each in ((round(value * 1.5, 9), value * 0.5) if value else (1.0,)))


def _filter(node: ast.comprehension) -> Iterator[ast.AST]:
    for at in range(len(node.ifs)):
        yield _with(node, ifs=[*node.ifs[:at], *node.ifs[at + 1 :]])


def _return(node: ast.Return) -> Iterator[ast.AST]:
    if node.value is not None and not isinstance(node.value, ast.Constant):
        yield _with(node, value=ast.Constant(None))
    if node.value is None:
        yield ast.copy_location(ast.Pass(), node)


def _call(node: ast.Call) -> Iterator[ast.AST]:
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    if name in CALLS:
        yield _with(node, func=_with(node.func, id=CALLS[name]))
    if name in ("max", "min") and len(node.args) > 1:
        yield from (each for each in node.args if not isinstance(each, ast.Starred))
    for at in range(len(node.keywords)):
        yield _with(node, keywords=[*node.keywords[:at], *node.keywords[at + 1 :]])


def _statement(node: ast.Expr | ast.Assign | ast.AugAssign | ast.Delete) -> Iterator[ast.AST]:
    """Yield nothing in place of a statement with an effect; without a local variable the rest would only crash."""
    if isinstance(node, ast.Expr) and not isinstance(node.value, ast.Call):
        return
    if not isinstance(node, ast.Assign) or isinstance(node.targets[0], ast.Attribute | ast.Subscript):
        yield ast.copy_location(ast.Pass(), node)


CHANGES: dict[tuple[type[ast.AST], ...], Callable[..., Iterator[ast.AST]]] = {
    (ast.Compare,): _compare,
    (ast.BoolOp,): _boolean,
    (ast.UnaryOp,): _unary,
    (ast.BinOp,): _binary,
    (ast.AugAssign,): _augmented,
    (ast.Constant,): _constant,
    (ast.comprehension,): _filter,
    (ast.Return,): _return,
    (ast.Call,): _call,
    (ast.Expr, ast.Assign, ast.AugAssign, ast.Delete): _statement,
}
"""Kinds of syntax nodes -> what may stand in their place. To add a kind of mutant, write a function and add a line."""


def _enum_members(node: ast.AST, namespace: Namespace) -> Iterator[ast.AST]:
    """Yield the next member for a member of an Enum, written as an attribute or as a module's name for the member."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        kind = namespace.get(node.value.id)
        if isinstance(kind, EnumType) and node.attr in kind.__members__ and kind.__name__ not in IGNORED_ENUMS:
            yield _with(node, attr=_next(list(kind.__members__), node.attr))
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        member = namespace.get(node.id)
        if isinstance(member, Enum):
            same = [name for name, value in namespace.items() if type(value) is type(member)]
            yield _with(node, id=_next(same, node.id))


def _next(names: list[str], name: str) -> str:
    return names[(names.index(name) + 1) % len(names)]
