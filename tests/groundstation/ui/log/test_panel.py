"""The log panel."""

from __future__ import annotations

from groundstation.snapshot import LogLine
from groundstation.ui.log.panel import LogPanel
from tests.groundstation.ui.examples import NOON
from tests.groundstation.ui.frames import texts


def test_control_characters_of_wire_do_not_reach_the_terminal() -> None:
    nasty = LogLine(time=0.0, severity=6, label="vehicle", text="a\x1b[2Jb\x07\n", count=1)
    assert "\x1b" not in "".join(texts(LogPanel((nasty,)).draw(80, 1)))


def test_the_log_shows_the_newest_and_how_often() -> None:
    lines = tuple(LogLine(time=0.0, severity=6, label="vehicle", text=str(n), count=n) for n in range(10))
    shown = texts(LogPanel(lines).draw(80, 3))
    assert [line.split()[2] for line in shown] == ["7", "8", "9"]
    assert "×9" in shown[-1]


def test_a_line_that_is_cut_ends_with_an_ellipsis() -> None:
    line = LogLine(time=NOON, severity=6, label="vehicle", text="a text of thirty characters...")
    (shown,) = texts(LogPanel((line,)).draw(40, 1))
    assert (len(shown), shown[-1]) == (40, "…")
    (whole,) = texts(LogPanel((line,)).draw(46, 1))
    assert whole.endswith("characters...")
