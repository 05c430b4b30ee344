"""Timestamps of a key on its way through the three programs, for hops.py. Python imports this module by its name.

It acts in a process whose environment names a folder for traces, and wraps the functions in HOPS when their modules are
imported. A timestamp costs about 1 us and does not release the interpreter lock, which would change what is measured.
"""

from __future__ import annotations

import atexit
import functools
import gc
import importlib.abc
import importlib.machinery
import os
import sys
import time
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

FOLDER = os.environ.get("MAVHELM_BENCH_HOPS", "")

HOPS = {
    "groundstation.ui.terminal.console_driver": (("ConsoleDriver._read", "woken", ""),),
    "groundstation.ui.terminal.key_parser": (("KeyEventParser.feed", "read", ""),),
    "groundstation.ui.keys.key_gate": (("KeyGate.handle_keys", "gate", ""),),
    "groundstation.client": (("StationClient.send", "", "sent"),),
    "groundstation.host.screen_port": (("ScreenPort._read", "piped", ""),),
    "groundstation.host.screens": (("ScreenSet.handle_batch", "decoded", ""),),
    "link.transport.udp": (("UdpTransport.send", "encoded", ""), ("UdpTransport._readable", "arrived", "")),
    "groundstation.ui.app.app": (("ConsoleApp._show", "show", "shown"),),
    "textual.app": (("App._display", "paint", "painted"),),
}
"""Module -> functions, the name of the timestamp at their begin and at their end; "" for none."""

KEPT = 2000
"""Timestamps that are kept in memory between two writes."""

_stamps: list[tuple[int, int, str]] = []


def record(name: str) -> None:
    """Note the time and the CPU time of this thread."""
    _stamps.append((time.monotonic_ns(), time.thread_time_ns(), name))


def write() -> None:
    """Append what is kept to the file of this process."""
    stamps = _stamps[:]
    del _stamps[: len(stamps)]
    with open(os.path.join(FOLDER, str(os.getpid())), "a", encoding="ascii") as file:
        file.writelines(f"{at} {cpu} {name}\n" for at, cpu, name in stamps)


def _wrap(module: ModuleType, path: str, begin: str, end: str) -> None:
    owner: Any = module
    *parents, name = path.split(".")
    for parent in parents:
        owner = getattr(owner, parent)
    function: Callable[..., Any] = getattr(owner, name)

    @functools.wraps(function)
    def traced(*arguments: Any, **options: Any) -> Any:
        if begin:
            record(begin)
        result = function(*arguments, **options)
        if end:
            record(end)
        if len(_stamps) > KEPT:
            write()
        return result

    setattr(owner, name, traced)


class _Loader(importlib.abc.Loader):
    """Loads a module as it would be without, then wraps its functions."""

    def __init__(self, loader: importlib.abc.Loader, name: str) -> None:
        self._loader, self._name = loader, name

    def create_module(self, spec: importlib.machinery.ModuleSpec) -> ModuleType | None:
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        self._loader.exec_module(module)
        for hop in HOPS[self._name]:
            _wrap(module, *hop)


class _Finder(importlib.abc.MetaPathFinder):
    """Finds the modules of HOPS."""

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if name not in HOPS:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        if spec is not None and spec.loader is not None:
            spec.loader = _Loader(spec.loader, name)
        return spec


def _collected(phase: str, info: dict[str, int]) -> None:
    record(f"gc{info['generation']}" if phase == "start" else "gc_end")


if FOLDER:
    sys.meta_path.insert(0, _Finder())
    gc.callbacks.append(_collected)
    atexit.register(write)
