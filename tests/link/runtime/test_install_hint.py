"""The line that installs an extra works in any shell, for the Python that runs."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from link.runtime.install_hint import install_command

ROOT = Path(__file__).parents[3]
PIP = re.compile(r"""["'].*\bpip (install|download)\b""")


def test_it_names_the_python_that_runs() -> None:
    assert install_command("web") == f"{sys.executable} -m pip install 'mavhelm[web]'"


def test_a_space_in_the_path_is_quoted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "/home/me/my rover/bin/python")
    assert install_command("pi") == "'/home/me/my rover/bin/python' -m pip install 'mavhelm[pi]'"


def test_an_environment_without_pip_is_for_uv(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert install_command("ros") == f"uv pip install --python {sys.executable} 'mavhelm[ros]'"


def test_no_other_message_of_the_programs_names_pip() -> None:
    """A message with a `pip` of its own would name the system's."""
    sources = (path for folder in ("link", "vehicle", "groundstation") for path in (ROOT / folder).rglob("*.py"))
    own = [path.name for path in sources if any(map(PIP.search, path.read_text().splitlines()))]
    assert own == ["install_hint.py"]
