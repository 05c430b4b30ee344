"""The lines that `make installs` types are those of docs/install.md."""

from __future__ import annotations

from pathlib import Path

from tests.installs.__main__ import install_lines

PAGE = Path(__file__).parents[2] / "docs/install.md"


def test_each_way_to_install_has_a_line() -> None:
    lines = install_lines(PAGE.read_text())
    assert [line.split()[0] for line in lines] == ["python3", "pipx", "uv", "uvx"]
    assert all("--no-index --find-links wheels" in line for line in lines)
