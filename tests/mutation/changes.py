"""Replacements for syntax nodes: the kinds of mutants.

To add a kind, write a function and add a line to CHANGES.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterator, Mapping
from enum import Enum, EnumType

IGNORED_ENUMS = ("Severity",)
"""Enums that are not mutated: the severity of a text is tested with its display."""
COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In,
}  # fmt: skip
ORDER = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Mod: ast.Mult, ast.Pow: ast.Mult,
    ast.BitOr: ast.BitAnd, ast.BitAnd: ast.BitOr, ast.FloorDiv: ast.Mult,
    ast.LShift: ast.RShift, ast.RShift: ast.LShift, ast.BitXor: ast.BitOr,
}  # fmt: skip
CALLS = {"max": "min", "min": "max", "any": "all", "all": "any"}

Namespace = Mapping[str, object]


def build_changes(node: ast.AST, field: str, namespace: Namespace) -> Iterator[ast.AST]:
    """Yield the replacements for `node`, which is in `field` of its parent."""
    if field == "test" and not isinstance(node, ast.UnaryOp | ast.Compare):
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
    """Yield `pass` for a statement with an effect, but not for a local variable: the function would only crash."""
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
"""Kinds of syntax nodes -> their replacements."""


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
            if len(same) > 1:
                yield _with(node, id=_next(same, node.id))


def _next(names: list[str], name: str) -> str:
    return names[(names.index(name) + 1) % len(names)]
