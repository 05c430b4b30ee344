"""A development tool without the packages of its extra ends with one line that names it."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

from tests.extras import MISSING, find, needing

ROOT = Path(__file__).parents[1]
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
TOOLS = {
    "animation": "pictures", "benchmarks": "test", "groundstation.ui.screenshots": "test,pictures",
    "mutation": "test,mutation", "oldest": "test", "soak": "test",
}  # fmt: skip
"""Program below tests/ -> what it needs."""


@pytest.mark.parametrize("tool", TOOLS)
def test_a_tool_without_packages_names_its_extra(tool: str) -> None:
    command = [sys.executable, "-S", "-m", f"tests.{tool}", "--help"]  # -S: no site-packages
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (MISSING, ""), done.stderr
    assert re.fullmatch(rf"the package \w+ is missing: .* 'mavhelm\[{TOOLS[tool]}\]'\n", done.stderr)


def test_what_is_there_is_imported() -> None:
    with needing("test"):
        import_module("pytest")
    find("test", ["pytest"])


def test_a_missing_module_is_named_without_importing(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        find("docs", ["sys", "no_such_package"])
    assert ended.value.code == MISSING
    assert capsys.readouterr().err.startswith("the package no_such_package is missing: ")


def test_a_missing_module_of_this_tree_is_a_fault() -> None:
    with pytest.raises(ModuleNotFoundError), needing("test"):
        import_module("tests.no_such_module")


def test_targets_ask_for_extras_that_exist() -> None:
    asked = re.findall(r"^\t\$\(NEEDS\) (\S+) \S", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert len(asked) > 8
    assert set(asked) <= EXTRAS.keys()
