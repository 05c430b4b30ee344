"""The version of the protocol: the same in a station, a screen and every other program that speaks it."""

from __future__ import annotations

import subprocess
import sys

import pytest

EVERY_MODULE = """
import importlib, pkgutil, sys
import groundstation.{package}
for each in pkgutil.iter_modules(groundstation.{package}.__path__, "groundstation.{package}."):
    importlib.import_module(each.name)
"""
VERSION = "from groundstation.ipc import protocol_version\nprint(protocol_version())"


def version_after(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", f"{code}\n{VERSION}"], capture_output=True, text=True, check=True)
    return done.stdout


@pytest.mark.parametrize("first", [*(EVERY_MODULE.format(package=each) for each in ("intents", "views")),
                                   "import groundstation.ui.app.app", "import groundstation.verbs.table"],
                         ids=["intents", "views", "screen", "verbs"])  # fmt: skip
def test_the_version_does_not_depend_on_other_loaded_modules(first: str) -> None:
    assert version_after(first) == version_after("")
