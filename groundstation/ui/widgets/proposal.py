"""What an agent proposes, in its own words, with what bounds it; on other screens than Drive with the keys, too."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.snapshot.agents import ProposalView
from groundstation.ui.display.agent_texts import hold_text, proposal_text
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import PANEL, TEXT, YELLOW, badge, style
from groundstation.ui.widgets.instrument import Instrument, cropped, strip


def bounds_text(proposal: ProposalView) -> str:
    """Return what bounds a proposal."""
    meters = "" if proposal.meters is None else f", {proposal.meters:g} m"
    return f"at most {proposal.seconds:g} s{meters}"


class ProposalLines(Instrument[ProposalView | None]):
    """Who proposes what, and why: on Drive, above the alert that names the keys."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw two lines."""
        return [] if self.value is None else _draw_lines(self.value, width)


class ProposalBarValue(msgspec.Struct, frozen=True):
    """A proposal, and the line with the keys that count."""

    proposal: ProposalView | None = None
    text: str = ""

    @classmethod
    def from_state(cls, now: DisplayState) -> ProposalBarValue:
        """Return the bar of a display state."""
        proposal = now.snapshot.proposal
        if proposal is None:
            return cls()
        return cls(proposal, proposal_text(now) if now.hold is None else hold_text(now.hold, now.snapshot.vehicle))


class ProposalBar(Instrument[ProposalBarValue]):
    """The same on the other screens, below the line that names the keys there."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw three lines."""
        if self.value.proposal is None:
            return []
        keys = strip((f" ? {clean(self.value.text)}".ljust(width), badge(YELLOW)))
        return [cropped(keys, width), *_draw_lines(self.value.proposal, width)]


def _draw_lines(proposal: ProposalView, width: int) -> list[Strip]:
    """Draw two lines; the reason is the agent's, and stands in quotes."""
    more = f" · {proposal.waiting} more wait" if proposal.waiting else ""
    what = f" {proposal.text}, {bounds_text(proposal)}{more} · {proposal.who}"
    why = f" “{proposal.reason}”"
    return [
        cropped(strip((" AGENT ", badge(YELLOW)), (clean(what).ljust(width), style(TEXT, PANEL))), width),
        cropped(strip((" why   ", style(TEXT, PANEL)), (clean(why).ljust(width), style(TEXT, PANEL))), width),
    ]
