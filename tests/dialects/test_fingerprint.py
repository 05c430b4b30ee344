"""A generated dialect that is older than its definitions is told in one line, before any test runs."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from dialects import fingerprint
from dialects.fingerprint import HERE, INPUTS, fault, line

ROOT = Path(__file__).parents[2]
OLDER = f"dialects/rover.py is older than its definitions: run {sys.executable} -m pip install -e {ROOT} to generate it"
MISSING = f"dialects/rover.py is missing: run {sys.executable} -m pip install -e {ROOT} to generate it"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Definitions, and a module that says that it is made from them."""
    place = tmp_path / "dialects"
    place.mkdir()
    for name in ("__init__.py", "fingerprint.py", *INPUTS):
        shutil.copy(HERE / name, place)
    (place / "rover.py").write_text(f"CODE = 1\n{line(place)}\n")
    return place


def test_the_module_of_this_checkout_matches_its_definitions() -> None:
    assert fault() is None


@pytest.mark.parametrize("name", INPUTS)
def test_a_changed_definition_makes_the_module_old(folder: Path, name: str) -> None:
    assert fault(folder) is None
    with (folder / name).open("a") as definition:
        definition.write("\n")
    assert fault(folder) == OLDER


def test_another_pymavlink_makes_the_module_old(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fingerprint, "version", lambda name: "0.0")
    assert fault(folder) == OLDER


@pytest.mark.parametrize("code", ["", "CODE = 1\n"])
def test_a_module_from_before_fingerprints_is_old(folder: Path, code: str) -> None:
    (folder / "rover.py").write_text(code)
    assert fault(folder) == OLDER


def test_a_module_that_was_never_made_is_told(folder: Path) -> None:
    (folder / "rover.py").unlink()
    assert fault(folder) == MISSING


def test_pytest_stops_with_that_line_and_runs_nothing(folder: Path) -> None:
    tests = folder.parent / "tests"
    tests.mkdir()
    for name in ("conftest.py", "order.py", "suite.py"):
        shutil.copy(ROOT / "tests" / name, tests)
    (tests / "test_one.py").write_text("def test_one() -> None: pass\n")
    (folder.parent / "pytest.ini").write_text("[pytest]\npythonpath = .\naddopts = --import-mode=importlib\n")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"]

    def run() -> tuple[int, str]:
        done = subprocess.run(command, cwd=folder.parent, capture_output=True, text=True, timeout=180, check=False)
        return done.returncode, done.stdout + done.stderr

    code, words = run()
    assert (code, "1 passed" in words) == (0, True), words
    (folder / "rover.py").write_text("CODE = 0\n")
    assert run() == (1, f"{OLDER.replace(f'-e {ROOT}', f'-e {folder.parent}')}\n")
