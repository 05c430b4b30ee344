"""Changes of one vehicle's state as lines of the log: armed or not, mode, fence, and the ground station in control."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from groundstation.vehicles.state.vehicle_state import VehicleState


class _Seen(msgspec.Struct, frozen=True):
    armed: bool
    mode: str
    driver: int | None
    breach: str


class StateChanges:
    """Compares a vehicle's state with the one before. `system` is our system id."""

    def __init__(self, system: int) -> None:
        self._system = system
        self._before: _Seen | None = None

    def update(self, state: VehicleState) -> Iterator[str]:
        """Yield one text for each change; none for the first state."""
        before, now = self._before, _Seen(state.armed, state.mode, state.driver, state.breach)
        self._before = now
        if before is None or now == before:
            return
        if now.armed != before.armed:
            yield "armed" if now.armed else "disarmed"
        if now.mode != before.mode:
            yield f"mode {now.mode}, was {before.mode}"
        if now.breach != before.breach:
            yield now.breach or "inside the fence again"
        if now.driver != before.driver and (now.driver or before.driver):
            yield self._control(now.driver)

    def _control(self, driver: int | None) -> str:
        if not driver:
            return "no ground station in control"
        return f"ground station {driver}{' (this one)' if driver == self._system else ''} in control"
