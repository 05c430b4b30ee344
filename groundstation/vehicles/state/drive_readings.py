"""What the Drive screen shows of one vehicle beside its state: health, mission, speed, and the parameters for it."""

from __future__ import annotations

import math
from collections.abc import Mapping

from dialects import messages as m
from dialects.enums import Autopilot
from dialects.kinds import SpeedParam
from groundstation.vehicles.health.health import HealthReadings
from groundstation.vehicles.readings.battery_use import BatteryUse
from groundstation.vehicles.readings.drift import Drift
from groundstation.vehicles.readings.foreign_drive import drive_params
from groundstation.vehicles.readings.speed_series import SpeedSeries
from groundstation.vehicles.readings.step_meter import StepMeter
from groundstation.vehicles.state.mission_progress import MissionMessages
from groundstation.vehicles.state.vehicle_params import VehicleParams
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.vehicles.stops.stop_bounds import find_rules
from groundstation.vehicles.stops.stop_rules import StopFacts, StopRules
from link.core import Received

OUTPUT_REPORTS = (m.ServoOutputRaw, m.ActuatorOutputStatus)

SPEED_PARAMS = ("WP_SPEED", "CRUISE_SPEED")
"""The speed of a mission, of ArduPilot and our rover: the first that is above 0."""

SILENT = 1.5
"""s without a message after which the vehicle may have heard nothing of us either: one that tells little is asked for
1 Hz at least."""


class DriveReadings:
    """Collects them from the messages of its autopilot."""

    def __init__(self, state: VehicleState, params: VehicleParams) -> None:
        self.health = HealthReadings()
        self.mission = MissionMessages()
        self.speeds = SpeedSeries()
        self.battery_use = BatteryUse()
        self.drift = Drift()
        self.steps = StepMeter(state.key_timings)
        self.params = params
        self._state = state
        self._wanted_for: tuple[bool, int] | None = None

    def receive(self, received: Received, round_trip: float | None, now: float) -> None:
        """Handle a message of the vehicle; `round_trip` to it in s, None if not known."""
        if self.params.receive(received, now):
            self._wanted_for = None
        if received.component != self._state.component:
            return
        self.health.receive(received.message, now)
        self.mission.receive(received.message, now)
        if isinstance(received.message, OUTPUT_REPORTS) and not self._state.has_rover_dialect:
            self.steps.record_outputs(self._state.foreign.raw_outputs, round_trip, now)

    def tick(self, now: float) -> None:
        """Choose which parameters are read, and add a point to the series."""
        state, values = self._state, self.params.values
        wanted_for = (state.has_rover_dialect, len(values))
        if wanted_for != self._wanted_for:  # the values of some parameters name others
            self._wanted_for, state.foreign.values = wanted_for, values
            self.params.want(drive_params(state.autopilot, values))
            rules = self.rules
            self.params.want(rules.params if rules is not None else ())
            self.params.want(tuple(each.name for each in state.model.limits.all))
            self.params.want(SPEED_PARAMS if rules is not None and state.autopilot != Autopilot.PX4 else ())
        if self.speeds.is_due(now):
            self.battery_use.add(state.reading("battery_remaining"), now, armed=state.armed)
            self.speeds.add(state.speed if state.monitor.is_alive(now) else None, self.speed_demand(now), now)

    def flight_limits(self) -> dict[str, float | None]:
        """Return what full deflection asks for, of what flies, by the fields of VehicleView."""
        limits = self._state.model.limits
        return {
            "full_speed": self._limit(limits.speed),
            "full_turn": self._limit(limits.turn),
            "full_climb": self._limit(limits.climb),
        }

    def _limit(self, params: tuple[SpeedParam, ...]) -> float | None:
        values = self.params.values
        return next((values[each.name] * each.scale for each in params if each.name in values), None)

    @property
    def battery_left(self) -> float | None:
        """Return for how many s the battery lasts at the rate at which it was used; None while that is not known."""
        rate, left = self.battery_use.rate, self._state.reading("battery_remaining")
        return None if not rate or left is None else float(left) / rate

    @property
    def rules(self) -> StopRules | None:
        """What stops this vehicle."""
        state = self._state
        return find_rules(state.autopilot, own_dialect=state.has_rover_dialect, flies=state.model.flies)

    @property
    def plan_speed(self) -> float | None:
        """The speed at which the vehicle drives a mission, m/s; None: not known."""
        known = [self.params.values.get(name) for name in SPEED_PARAMS]
        return None if known[0] is None else next((speed for speed in known if speed and speed > 0.0), None)

    def speed_demand(self, now: float) -> float | None:
        """Return the speed that the obeyed demand requests, m/s; None unless ROVER_DRIVE_INFO has the top speed."""
        demand, info = self._state.demand(now), self._state.drive_info
        if demand is None or info is None or not math.isfinite(info.speed_max):
            return None
        return demand[0] * float(info.speed_max)

    def command_age(self, sent_age: float | None, round_trip: float | None, now: float) -> tuple[float | None, bool]:
        """Return the age of the newest demand that the vehicle has taken, s, and whether it is an estimate.

        `sent_age` is that of the newest demand that was sent; half a round trip later the vehicle has received it.
        """
        if self._state.has_rover_dialect:
            return self._state.command_age(now), False
        if sent_age is None:
            return None, True
        return self._at_least_silence(sent_age + (round_trip or 0.0) / 2, now), True

    def build_facts(
        self,
        settings: Mapping[str, float],
        age: tuple[float | None, bool],
        quiet: float | None,
        input_age: float | None,
        now: float,
    ) -> StopFacts:
        """Build the facts for the rules. `settings`: values that were read elsewhere; `quiet`: s since we sent."""
        state = self._state
        angles = (state.reading("roll"), state.reading("pitch"))
        return StopFacts(
            params={**settings, **self.params.values},
            kind=state.kind,
            drives_itself=state.drives_itself,
            command_age=age[0] if state.armed else None,
            estimated=age[1],
            quiet=None if quiet is None else self._at_least_silence(quiet, now),
            manual_timeout=state.drive_info.manual_timeout_ms / 1000 if state.drive_info else None,
            input_age=input_age,
            voltage=state.reading("battery_voltage"),
            tilt=max((abs(math.degrees(angle)) for angle in angles if angle is not None), default=None),
        )

    def _at_least_silence(self, seconds: float, now: float) -> float:
        """Return the time, or that for which the vehicle is silent: it may hear us no better than we hear it."""
        silence = self._state.monitor.silence(now)
        return max(seconds, silence) if silence > SILENT else seconds
