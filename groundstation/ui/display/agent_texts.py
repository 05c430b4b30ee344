"""The line that says which key lets a proposal of an agent run, or that it runs."""

from __future__ import annotations

from groundstation.input.hold_to_confirm import HoldProgress
from groundstation.intents.vehicle import TakeOff
from groundstation.snapshot import VehicleView
from groundstation.snapshot.agents import ProposalView
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.keys.key_gate import OTHER_SCREEN
from groundstation.ui.keys.keynames import format_key

BAR = 10
"""Cells of the progress of a held key."""


def hold_text(hold: HoldProgress, vehicle: VehicleView | None) -> str:
    """Return the progress of a key that is held to confirm an action."""
    full = int(BAR * hold.held / hold.action.hold_time)
    bar = "█" * full + "░" * (BAR - full)
    label = hold.action.label
    if isinstance(hold.action.intent, TakeOff) and vehicle is not None and vehicle.take_off is not None:
        label = f"{label} to {vehicle.take_off:g} m"
    return f"{label}: hold {format_key(hold.key)} {bar} {hold.held:.1f} s"


def proposal_text(now: DisplayState) -> str:
    """Return what the proposal that is shown waits for, with the keys that count here; "" without one."""
    proposal = now.snapshot.proposal
    if proposal is None:
        return ""
    permits, declines = now.agent_key("agent.permit"), now.agent_key("agent.decline")
    if proposal.runs:
        covered = f", {proposal.covered:.1f} m" if proposal.meters is not None else ""
        held = permits or now.key("agent.permit")
        return f"the AGENT acts while {held} is held: {proposal.ran:.1f} of {proposal.seconds:g} s{covered}"
    ends = f", {declines} declines" if declines else ""
    return f"agent asks: {_way(now, proposal, permits)}{ends} ({proposal.left:.0f} s): {proposal.text}"


def _way(now: DisplayState, proposal: ProposalView, permits: str) -> str:
    """Return what the operator can do to let it run."""
    if now.snapshot.lease.driver:
        return f"{now.snapshot.lease.driver} can permit it"
    if proposal.vehicle:
        opens = "" if now.screen.drives else f"on {now.key('app.drive')} Drive "
        return f"it is for {proposal.vehicle}: {opens}{now.key('vehicle.next')} selects it"
    if permits and (now.closure is None or now.closure.agent_keys):
        return f"hold {permits} to let it"
    if now.closure is None or now.closure.reason == OTHER_SCREEN.reason:
        return "no key lets it here now"
    return f"no key lets it now, {now.closure.reason}"
