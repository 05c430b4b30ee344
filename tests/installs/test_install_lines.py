"""The lines that `make installs` types are those of docs/install.md."""

from __future__ import annotations

from pathlib import Path

from tests.installs.__main__ import REMOVALS, UPDATES, install_lines

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "install.md"


def test_each_way_to_install_has_a_line() -> None:
    lines = install_lines(PAGE.read_text())
    assert [line.split()[0] for line in lines] == ["python3", "pipx", "uv", "uvx"]
    assert all("--no-index --find-links wheels" in line for line in lines)


def test_the_pages_have_the_words_that_update_and_uninstall() -> None:
    page = PAGE.read_text()
    assert [words for words in UPDATES.values() if f"`{words.split()[1]}`" not in page and words not in page] == []
    answer = (DOCS / "faq.md").read_text().partition("## How do I uninstall?")[2]
    assert [line for line in REMOVALS.values() if f"`{line}`" not in answer] == []
