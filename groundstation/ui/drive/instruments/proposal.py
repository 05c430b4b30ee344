"""What an agent proposes, in its own words, with what bounds it: two lines above the alert that names the keys."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.snapshot.agents import ProposalView
from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import PANEL, TEXT, YELLOW, badge, style
from groundstation.ui.widgets.instrument import Instrument, cropped, strip


def bounds_text(proposal: ProposalView) -> str:
    """Return what bounds a proposal."""
    meters = "" if proposal.meters is None else f", {proposal.meters:g} m"
    return f"at most {proposal.seconds:g} s{meters}"


class ProposalLines(Instrument[ProposalView | None]):
    """Who proposes what, and why."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw two lines; the reason is the agent's, and stands in quotes."""
        proposal = self.value
        if proposal is None:
            return []
        more = f" · {proposal.waiting} more wait" if proposal.waiting else ""
        what = f" {proposal.text}, {bounds_text(proposal)}{more} · {proposal.who}"
        why = f" “{proposal.reason}”"
        return [
            cropped(strip((" AGENT ", badge(YELLOW)), (clean(what).ljust(width), style(TEXT, PANEL))), width),
            cropped(strip((" why   ", style(TEXT, PANEL)), (clean(why).ljust(width), style(TEXT, PANEL))), width),
        ]
