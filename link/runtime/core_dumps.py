"""Keeps secrets out of core dumps."""

from __future__ import annotations

import contextlib
import resource


def forbid_core_dumps() -> None:
    """Write no memory image of this process, or of those that it starts from now on, if it crashes.

    Where a sandbox forbids the call, its owner has decided already (LimitCORE=0 in the unit of the vehicle).
    """
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
