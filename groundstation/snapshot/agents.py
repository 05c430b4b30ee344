"""What the screens show of the proposals of agents."""

from __future__ import annotations

import msgspec


class ProposalView(msgspec.Struct, frozen=True, kw_only=True):
    """The proposal that runs, or else the oldest one that waits."""

    number: int
    who: str
    """Which program has made it."""
    text: str
    reason: str
    """The agent's own words."""
    vehicle: str = ""
    """Name of its vehicle where another one is selected."""
    seconds: float
    """s for which it may run."""
    meters: float | None = None
    """m that it may cover."""
    runs: bool = False
    left: float = 0.0
    """s to permit it."""
    ran: float = 0.0
    """s for which it has run."""
    covered: float = 0.0
    """m that it has covered."""
    waiting: int = 0
    """Further proposals."""
