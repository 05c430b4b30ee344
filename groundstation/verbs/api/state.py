"""Builds the State that a program sees."""

from __future__ import annotations

import math

from groundstation.rover.telemetry import Position, State
from groundstation.verbs.session.contact import VehicleContact


def build_state(contact: VehicleContact, now: float) -> State:
    """Return the state of a vehicle."""
    state, view, place = contact.state, contact.state.build_view(now), contact.details.place
    throttle, steering = view.demand or (None, None)
    return State(
        system=state.system,
        name=state.name,
        mode=state.mode,
        armed=state.armed,
        alive=view.alive,
        silence=round(view.silence, 3),
        driver=state.driver,
        in_control=contact.in_control,
        emergency_stop=state.emergency_stop,
        failsafes=tuple(view.failsafes),
        ready_to_arm=view.prearm,
        not_ready_reason=view.prearm_reason or "",
        position=Position(place.latitude, place.longitude) if place else None,
        heading=_degrees(view.heading),
        roll=_degrees(view.roll),
        pitch=_degrees(view.pitch),
        speed=view.speed,
        voltage=view.battery_voltage,
        battery=view.battery_remaining,
        gps_fix=view.gps_fix,
        satellites=view.gps_satellites,
        throttle=throttle,
        steering=steering,
    )


def _degrees(angle: float | None) -> float | None:
    return None if angle is None else math.degrees(angle)
