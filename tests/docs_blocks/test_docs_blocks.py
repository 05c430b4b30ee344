"""Every shell block of docs/*.md is typed, page by page, or says why it is not."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.docs_blocks.machine import ROOT, why_not
from tests.docs_blocks.markdown import KINDS, Block, find_blocks

PAGES = sorted((ROOT / "docs").glob("*.md"))
BLOCKS = [(page, block) for page in PAGES for block in find_blocks(page.read_text())]
TYPED = sorted({page for page, block in BLOCKS if block.is_shell and "not run" not in block.notes})
EXPLAINED = {
    "hardware": 5,  # commands: a compass, a receiver; faq: a Bluetooth gamepad; pi: raspi-config; video: cameras
    "network": 20,  # agents, install: package indexes; faq, ros: uv; faq: git pull; browser, phone: ssh; fleet; remote
    "program": 2,  # ros: ROS 2
    "root": 16,  # faq: a firewall; faq, install, pi: packages, services; reliability: a VM; remote: a VPN; ros
    "time": 4,  # performance: an hour; reliability: the soak, the mutation run and the rounds on a late machine
}
"""Kind of reason -> how many blocks are explained with it. A new one is counted here, in the same change."""
OURS = re.compile(r"^\s*(?:\$ )?(?:mavhelm|python -m|pip|sudo|make)\b", re.MULTILINE)
TIMEOUT = 900
"""s; the page of all verbs takes 2 minutes on an idle machine."""


def run(page: Path) -> subprocess.CompletedProcess[str]:
    """Type the blocks of a page."""
    command = [sys.executable, "-m", "tests.docs_blocks", str(page)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.slow
@pytest.mark.e2e
@pytest.mark.timeout(TIMEOUT)
class TestPages:
    @pytest.fixture(autouse=True)
    def _namespaces(self) -> None:
        if "MAVHELM_CI" not in os.environ and (reason := why_not()):
            pytest.skip(f"no namespaces here: {reason}")

    @pytest.mark.parametrize("page", TYPED, ids=lambda page: page.stem)
    def test_each_shell_block_does_what_the_page_says(self, page: Path) -> None:
        done = run(page)
        assert done.returncode == 0, done.stdout + done.stderr

    @pytest.mark.parametrize(
        ("block", "says"),
        [
            ("```sh\nmavhelm config check --strict\n```\n", "unrecognized arguments: --strict"),
            ("```sh\nmavhelm bridge serial:/dev/ttyUSB0:57600 --tlogs logs\n```\n", "it ended with exit code 2"),
            ("```sh\nsudo reboot\n```\n", "explain the block"),
            ("```sh\necho 17 apples\n```\n<!-- output of: echo 17 apples -->\n```\n3 pears\n```\n", "3 pears"),
        ],
        ids=["option", "option of a program that stays", "root", "output"],
    )
    def test_a_block_that_is_wrong_fails(self, tmp_path: Path, block: str, says: str) -> None:
        page = tmp_path / "page.md"
        page.write_text(f"Text.\n\n{block}")
        done = run(page)
        assert done.returncode == 1
        assert "page.md:4" in done.stdout
        assert says in done.stdout


def test_each_block_that_is_not_run_is_counted() -> None:
    reasons = [block.notes["not run"].partition(": ") for _, block in BLOCKS if "not run" in block.notes]
    assert {kind for kind, _, _ in reasons} <= {*KINDS}
    assert all(why for _, _, why in reasons)
    assert Counter(kind for kind, _, _ in reasons) == EXPLAINED


def test_each_block_with_a_command_is_a_shell_block() -> None:
    """Or the output of one, which begins with the command behind a dollar sign."""
    others = [(page.name, block.line) for page, block in BLOCKS if not block.is_shell and shows_command(block)]
    assert others == []


def shows_command(block: Block) -> bool:
    return block.language == "" and OURS.search(block.text.removeprefix("$ mavhelm bridge doctor")) is not None


def test_comments_and_indentation_of_a_block() -> None:
    [first, second] = find_blocks(
        "1. Item\n\n   <!-- on: rover -->\n   <!-- first:\n   a\n   b\n   -->\n   ```sh\n   x \\\n     y\n   ```\n\n"
        "<!-- stays -->\n\n<!-- generated -->\n```\nz\n```\n"
    )
    assert first == Block(9, "sh", "x \\\n  y\n", {"on": "rover", "first": "a\n   b"})
    assert second == Block(17, "", "z\n", {"stays": ""})
    assert (first.is_shell, second.is_shell) == (True, False)


def test_a_comment_belongs_to_the_block_below_it_only() -> None:
    [one, two] = find_blocks("<!-- stays -->\n```sh\na\n```\n```sh\nb\n```\n")
    assert (one.notes, two.notes) == ({"stays": ""}, {})


def test_each_file_of_the_examples_is_used_on_a_page() -> None:
    """Programs have tests of their own: tests/test_examples.py."""
    first = "".join(block.notes.get("first", "") for _, block in BLOCKS)
    others = [each.name for each in (ROOT / "docs" / "examples").iterdir() if each.suffix in (".plan", ".keys", ".xml")]
    assert len(others) >= 3
    assert [name for name in others if f"docs/examples/{name}" not in first] == []


MODULES = re.compile(r"python -m (tests\.\w+)([^#\n]*)")
"""A program of the tests in an explained block: it runs for too long, but its options are looked up."""
LONG_RUNS = sorted({found for _, block in BLOCKS if "not run" in block.notes for found in MODULES.findall(block.text)})


@pytest.mark.e2e
@pytest.mark.parametrize("module", sorted({module for module, _ in LONG_RUNS}))
def test_options_of_a_block_that_takes_hours_exist(module: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", module, "--help"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    options = {word for name, words in LONG_RUNS if name == module for word in words.split() if word.startswith("--")}
    assert options - {*re.findall(r"--[\w-]+", done.stdout)} == set()
