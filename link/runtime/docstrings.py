"""Reads the docstrings of the fields of a class from its source, as help for the user."""

from __future__ import annotations

import ast
import inspect
import textwrap
from functools import cache


def field_docs(kind: type) -> dict[str, str]:
    """Return field -> first paragraph of its docstring, for a class and its bases."""
    kinds = [each for each in reversed(kind.__mro__) if "__annotations__" in vars(each)]
    return {name: text for each in kinds for name, text in _own_docs(each).items()}


@cache
def _own_docs(kind: type) -> dict[str, str]:
    body = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
    assert isinstance(body, ast.ClassDef)
    pairs = zip(body.body, body.body[1:], strict=False)
    return {
        field.target.id: first_paragraph(text.value.value)
        for field, text in pairs
        if isinstance(field, ast.AnnAssign)
        and isinstance(field.target, ast.Name)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
        and isinstance(text.value.value, str)
    }


def first_paragraph(text: str | None) -> str:
    """Return the first paragraph of a docstring as one line."""
    return " ".join(inspect.cleandoc(text or "").partition("\n\n")[0].split())
