"""A manual page for each program, verb and subcommand, with all options, that man can show."""

from __future__ import annotations

import argparse
import shutil
import subprocess
from pathlib import Path

import pytest
from manpages.pages import build_pages
from manpages.roff import Edition, Page, build, escape

from groundstation.cli.verb_help import LOCAL_VERBS
from groundstation.verbs.table import VERBS
from tests.rows import each_row
from vehicle.cli.subcommands import SUBCOMMANDS

EDITION = Edition("0.1.0", "2026-11-27")
PAGES = {page.name: page for page in build_pages()}


@pytest.fixture(autouse=True)
def _wide_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "10000")


def test_every_verb_and_subcommand_has_a_page() -> None:
    verbs = {f"mavhelm-{verb}" for verb in (*VERBS, *LOCAL_VERBS)}
    assert PAGES.keys() == {"mavhelm", "vehicle", "mavhelm-bridge"} | verbs | {
        f"vehicle-{name}" for name in SUBCOMMANDS
    }


def flags(parser: argparse.ArgumentParser) -> set[str]:
    """Return the options of a parser and of its actions that --help shows."""
    found = {flag for each in parser._actions if each.help != argparse.SUPPRESS for flag in each.option_strings}
    for each in parser._actions:
        if isinstance(each, argparse._SubParsersAction):
            found = found.union(*map(flags, each.choices.values()))
    return found


@each_row("page", PAGES.values(), ids=lambda page: page.name)
def test_a_page_has_all_options(page: Page) -> None:
    text = build(page, EDITION)
    assert len(flags(page.parser)) >= 1
    assert [flag for flag in flags(page.parser) if escape(flag) not in text] == []
    assert text.startswith(f'.TH {escape(page.name.upper())} 1 2026-11-27 "mavhelm 0.1.0" "User Commands"\n')
    assert "%(" not in text


def test_no_text_is_a_command_of_roff() -> None:
    assert escape(".SH x\n'a' -b \\c ~/d") == "\\&.SH x\n\\(aqa\\(aq \\-b \\ec \\(ti/d"


@pytest.mark.skipif(shutil.which("mandoc") is None, reason="the program mandoc is missing")
def test_mandoc_has_nothing_to_say(tmp_path: Path) -> None:
    for page in PAGES.values():
        (tmp_path / f"{page.name}.1").write_text(build(page, EDITION))
    linted = subprocess.run(
        ["mandoc", "-T", "lint", "-W", "warning", *sorted(tmp_path.iterdir())],
        capture_output=True,
        text=True,
        check=False,
    )
    assert linted.stdout == ""
