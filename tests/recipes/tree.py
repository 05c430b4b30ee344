"""A copy of the source tree, in which a test follows a recipe of CONTRIBUTING.md and runs the result."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from tests.ports import free_port

ROOT = Path(__file__).parents[2]
PACKAGES = ("dialects", "link", "vehicle", "groundstation", "tests")
LEFT_OUT = shutil.ignore_patterns("mutation", "benchmarks", "*-pytest-*", "*.pyc.*")
"""Also the byte code of tests, and that which another program is writing just now."""
RUN_TIMEOUT = 60.0
"""s for one program in the copy."""


def documented_counts() -> dict[str, int]:
    """Return the recipes of CONTRIBUTING.md and the number of files that each touches."""
    rows = re.findall(r"^\| (an? [^|]+) \| (\d) \|", (ROOT / "CONTRIBUTING.md").read_text(), re.MULTILINE)
    return {name: int(count) for name, count in rows}


class Tree:
    """A copy of the packages; `touched` are the files that the recipe has written or edited."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.touched: set[str] = set()
        self.port = free_port()
        """A port for the programs of the copy."""
        for package in PACKAGES:  # with byte code, so that programs start as fast as in the original
            shutil.copytree(ROOT / package, folder / package, ignore=LEFT_OUT)

    def write(self, path: str, text: str) -> None:
        """Add a file that does not exist yet."""
        target = self.folder / path
        assert not target.exists(), f"{path} exists already"
        target.write_text(text)
        self.touched.add(path)

    def insert_after(self, path: str, anchor: str, text: str) -> None:
        """Insert lines after the one line that contains `anchor`."""
        lines = self._lines(path)
        at = self._find(path, lines, anchor)
        self._save(path, [*lines[: at + 1], text.rstrip("\n"), *lines[at + 1 :]])

    def insert_before(self, path: str, anchor: str, text: str) -> None:
        """Insert lines before the one line that contains `anchor`."""
        lines = self._lines(path)
        at = self._find(path, lines, anchor)
        self._save(path, [*lines[:at], text.rstrip("\n"), *lines[at:]])

    def replace(self, path: str, old: str, new: str) -> None:
        """Replace the only occurrence of `old`."""
        text = (self.folder / path).read_text()
        assert text.count(old) == 1, f"{path} contains {text.count(old)} times {old!r}"
        self._save(path, [text.replace(old, new).removesuffix("\n")])

    def append(self, path: str, text: str) -> None:
        """Add lines at the end of a file."""
        self._save(path, [*self._lines(path), text.rstrip("\n")])

    def check_recipe(self, name: str) -> None:
        """Check that as many files were touched as the row `name` of CONTRIBUTING.md says."""
        count = documented_counts()[name]
        assert len(self.touched) == count, f"{name}: {sorted(self.touched)}, CONTRIBUTING.md says {count}"

    def run(self, *words: str, fails: bool = False) -> str:
        """Run `python -m` with `words` in the copy; return its standard output and error."""
        done = subprocess.run(
            [sys.executable, "-m", *words],
            cwd=self.folder,
            env=self.environment(),
            capture_output=True,
            text=True,
            timeout=RUN_TIMEOUT,
            check=False,
        )
        assert (done.returncode != 0) is fails, done.stdout + done.stderr
        return done.stdout + done.stderr

    def run_script(self, script: str) -> str:
        """Run a script, with the packages of the copy; return what it prints."""
        (self.folder / "recipe_script.py").write_text(script)
        return self.run("recipe_script")

    def environment(self) -> dict[str, str]:
        """Return the environment in which Python finds the packages of the copy, and not the installed ones."""
        return {**os.environ, "PYTHONPATH": str(self.folder), "PYTHONWARNINGS": "error"}

    def _lines(self, path: str) -> list[str]:
        return (self.folder / path).read_text().splitlines()

    def _find(self, path: str, lines: list[str], anchor: str) -> int:
        found = [number for number, line in enumerate(lines) if anchor in line]
        assert len(found) == 1, f"{path} has {len(found)} lines with {anchor!r}: the recipe needs another anchor"
        return found[0]

    def _save(self, path: str, lines: list[str]) -> None:
        (self.folder / path).write_text("\n".join(lines) + "\n")
        self.touched.add(path)
