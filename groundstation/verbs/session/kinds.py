"""What verbs check of the kind of a vehicle (dialects/kinds.py) before they move it."""

from __future__ import annotations

from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.common.exit_codes import ExitCode, VerbError


def need_driven(state: VehicleState) -> None:
    """Raise VerbError for a vehicle of a kind that is only shown."""
    if state.model.refusal:
        raise VerbError(ExitCode.REFUSED, f"{state.name}: {state.model.refusal}")
