"""FaultSettings: which faults a link has. Apart from the faults, because a command line reads it."""

from __future__ import annotations

import msgspec

CUT_AFTER = 2.0
"""s for which the wheels turn before a cut begins: long enough to see that the rover drives."""


class FaultSettings(msgspec.Struct, frozen=True):
    """Which faults a link has, in each direction."""

    loss: float = 0.0
    """Fraction of the frames that is lost, 0 to 1."""
    delay: float = 0.0
    """s from one end to the other."""
    jitter: float = 0.0
    """s by which the delay varies, up and down."""
    cut: float = 0.0
    """s for which nothing passes, each time the wheels have turned for CUT_AFTER."""
    seed: int = 1
    """Of chance: the same frames at the same times are lost again with the same seed."""
