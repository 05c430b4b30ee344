"""The real program in terminals that show ASCII only, and in one that cannot place text."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.e2e.programs import GroundStation
from tests.groundstation.cli.test_main import in_terminal
from tests.ports import free_port
from tests.waits import PATIENCE

pytestmark = pytest.mark.e2e


@pytest.mark.parametrize(
    ("locale", "options", "ascii_only", "term"),
    [
        ("C.UTF-8", (), False, "xterm-256color"),
        ("C.UTF-8", ("--ascii",), True, "xterm-256color"),
        ("C", (), True, "vt100"),
        ("C", ("--no-ascii",), False, "cygwin"),
    ],
)
def test_the_terminal_gets_only_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, locale: str, options: tuple[str, ...], ascii_only: bool, term: str
) -> None:
    for name in ("LC_ALL", "LC_CTYPE", "PYTHONUTF8"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("LANG", locale)
    station = GroundStation(tmp_path, f"udpin:127.0.0.1:{free_port()}", *options, term=term)
    try:
        station.wait_for(lambda: b"shows the keys" in station.screen, PATIENCE, "the first page")
        station.type("\x11")
        assert station.ended() == 0
        assert station.screen.isascii() is ascii_only
    finally:
        station.end()


def test_a_dumb_terminal_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TERM", "dumb")
    code, shown = in_terminal(["--sitl"])
    assert code == 2
    assert shown == (
        "mavhelm: TERM=dumb cannot place text on the screen: run mavhelm in a terminal such as xterm or tmux\n"
    )
