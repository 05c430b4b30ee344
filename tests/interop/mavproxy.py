"""MAVProxy as a program with typed commands, in a virtual environment of its own, because it needs other libraries."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.interop.conversation import Conversation

MAVPROXY = Path(__file__).parents[2] / ".venv-mavproxy/bin"
"""`.ci/run` creates it."""
MODULES = "log,wp,rally,fence,ftp,param,arm,mode,rc,misc,cmdlong,battery,relay"
"""Those of its default modules that need no map, plot or screen."""

needed = pytest.mark.skipif(
    not (MAVPROXY / "mavproxy.py").exists() and "MAVHELM_CI" not in os.environ,
    reason="MAVProxy is not installed: .ci/run shows how to put it into .venv-mavproxy",
)


@contextmanager
def started(port: int, folder: Path, system: int = 255) -> Iterator[Conversation]:
    """MAVProxy, listening on a UDP port; its files go to `folder`."""
    program = Conversation(
        [
            str(MAVPROXY / "python"),
            str(MAVPROXY / "mavproxy.py"),
            f"--default-modules={MODULES}",
            f"--source-system={system}",
            f"--master=udpin:127.0.0.1:{port}",
        ],
        folder,
    )
    try:
        yield program
    finally:
        program.end()


def plan_file(command: int, first: int, places: Sequence[tuple[float, float]]) -> str:
    """Return a plan in MAVProxy's format; `first` is parameter 1 of each item."""
    lines = (f"{n}\t0\t3\t{command}\t{first}\t0\t0\t0\t{x:.7f}\t{y:.7f}\t0\t1" for n, (x, y) in enumerate(places))
    return "\n".join(["QGC WPL 110", *lines, ""])
