"""Install the oldest versions that pyproject.toml allows, and run the tests that use each of them: make oldest.

A virtual environment of its own gets them, and the newest pytest that the extra `test` allows.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from tests.extras import needing

with needing("test"):
    from packaging.requirements import Requirement

    from tests.oldest.bounds import EXTRAS, TESTS, lower_bounds


ROOT = Path(__file__).resolve().parents[2]
PYTEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not slow and not e2e and not tmux")


def main(words: list[str]) -> int:
    """Return pytest's exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.oldest", description=__doc__.partition("\n")[0])
    parser.add_argument("tests", nargs="*", help="tests to run (default: those of tests/oldest/bounds.py)")
    options = parser.parse_args(words)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    oldest = lower_bounds(project)
    with tempfile.TemporaryDirectory(prefix="mavhelm-oldest-") as folder:
        python = _install(Path(folder), oldest, project["optional-dependencies"]["test"])
        print("oldest:", ", ".join(f"{name} {version}" for name, version in sorted(oldest.items())), flush=True)
        tests = options.tests or sorted({path for paths in TESTS.values() for path in paths})
        return subprocess.run([python, *PYTEST, *tests], cwd=ROOT, check=False).returncode


def _install(folder: Path, oldest: dict[str, str], suite: list[str]) -> str:
    """Make the environment; return its Python."""
    subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
    python = str(folder / "venv" / "bin" / "python")
    constraints = folder / "oldest.txt"
    constraints.write_text("".join(f"{name}=={version}\n" for name, version in oldest.items()))
    programs = [line for line in suite if Requirement(line).name.startswith(("pytest", "hypothesis"))]
    _pip(python, "-c", str(constraints), f"{ROOT}[{','.join(EXTRAS)}]", *programs)
    return python


def _pip(python: str, *words: str) -> None:
    subprocess.run([python, "-m", "pip", "install", "-q", "--no-compile", *words], check=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
