"""Import modules of verbs on first use: importing all of them takes longer than most verbs do."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from importlib import import_module
from operator import attrgetter
from typing import Any


class LazyAttribute:
    """Stand-in for a function, sequence or class attribute of a module that is imported on first use."""

    def __init__(self, module: str, name: str) -> None:
        self._module = module
        self._name = name

    def resolve(self) -> Any:
        """Import the module, and return what the name stands for. Raises ImportError, AttributeError."""
        return attrgetter(self._name)(import_module(self._module))

    def __call__(self, *arguments: Any) -> Any:
        """Call it."""
        return self.resolve()(*arguments)

    def __iter__(self) -> Iterator[Any]:
        """Return its items."""
        return iter(self.resolve())


class LazyModule:
    """Stand-in for a module of groundstation.verbs that is imported on first use."""

    def __init__(self, name: str) -> None:
        self._name = f"groundstation.verbs.{name}"

    def __getattr__(self, name: str) -> LazyAttribute:
        """Return one of its names, which is not looked up yet."""
        return LazyAttribute(self._name, name)


class LazyCall:
    """A call of a function of the table, made on first use."""

    def __init__(self, factory: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        self._factory, self._arguments = factory, arguments

    def resolve(self) -> Any:
        """Import the module of the factory, and return what it makes. Raises ImportError, AttributeError."""
        known = (each.resolve() if isinstance(each, LazyAttribute) else each for each in self._arguments)
        return self._factory(*known)

    def __call__(self, *arguments: Any) -> Any:
        """Call it."""
        return self.resolve()(*arguments)


def lazy_call(factory: Callable[..., Any], *arguments: Any) -> Callable[..., Any]:
    """Return the function that `factory` makes of the arguments; it is made when it is called."""
    return LazyCall(factory, arguments)
