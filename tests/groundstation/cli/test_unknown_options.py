"""What the user meant by an unknown option."""

from __future__ import annotations

import pytest

from groundstation.cli.unknown_options import describe_unknown

OPTIONS = ("--sitl", "--keys", "--style", "--speed", "--system", "--log-file", "--dialect")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["--stil"], "unrecognized arguments: --stil: did you mean --sitl?"),
        (["--sytem=3"], "unrecognized arguments: --sytem=3: did you mean --system?"),
        (["--fly", "--spede"], "unrecognized arguments: --fly --spede: did you mean --speed?"),
        (["--console"], "unrecognized arguments: --console: the screen shows what it would; leave it out"),
        (["--dialct=a.xml"], "unrecognized arguments: --dialct=a.xml: did you mean --dialect?"),
        (["--fly"], "unrecognized arguments: --fly"),
        (["-x"], "unrecognized arguments: -x"),
        (["--baud"], "unrecognized arguments: --baud: write serial:PATH:BAUD, e.g. serial:/dev/ttyUSB0:57600"),
        (["--source-system=254"], "unrecognized arguments: --source-system=254: use --system"),
    ],
)
def test_the_line(arguments: list[str], line: str) -> None:
    assert describe_unknown(arguments, OPTIONS) == line
