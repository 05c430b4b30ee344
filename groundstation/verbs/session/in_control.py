"""Who is in control of a vehicle, as a program with ids and a session sees it."""

from __future__ import annotations

from groundstation.vehicles.state.vehicle_state import VehicleState


def is_in_control(state: VehicleState, ids: tuple[int, int], session: int) -> bool:
    """Return whether the program is in control, as the vehicle reports it."""
    return bool(state.driver) and state.control.is_program(ids, session, accepted=False)


def other_driver(state: VehicleState, ids: tuple[int, int], session: int) -> int | None:
    """Return the system id of another program in control; None if there is none, or the vehicle does not tell."""
    return state.driver if state.driver and not is_in_control(state, ids, session) else None
