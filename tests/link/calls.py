"""Which functions of link/protocol a call takes: where frames arrive, each costs as much as the checksum."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType


def called(run: Callable[[], object]) -> list[str]:
    """Names of the functions of link/protocol that `run` calls, in order."""
    names: list[str] = []

    def note(frame: FrameType, event: str, _: object) -> None:
        if (
            event == "call"
            and "/link/protocol/" in frame.f_code.co_filename
            and "/tests/" not in frame.f_code.co_filename
        ):
            names.append(frame.f_code.co_name)

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(before)
    return names
