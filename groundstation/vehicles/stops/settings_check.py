"""Reads the parameters of a foreign vehicle that decide what it does without us, and warns of dangerous values.

The station only reads; which values are right is the owner's decision. The parameters of each autopilot are in
SETTINGS.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from dialects.enums import Autopilot
from dialects.messages import ParamValue
from groundstation.vehicles.stops.altitude_fence import AltitudeFence
from groundstation.vehicles.stops.ardupilot_checks import ARDUPILOT
from groundstation.vehicles.stops.autopilot_settings import AutopilotSettings
from groundstation.vehicles.stops.copter_checks import ARDUPILOT_COPTER, PX4_COPTER
from groundstation.vehicles.stops.px4_checks import PX4
from link.core import Outgoing, Received
from link.services.param.client import ParamClient

REPEAT_AFTER = 1.0
"""s: a parameter takes 0.1 s over UDP and up to 1 s over 57600 baud; unknown ones are not answered."""

TRIES = 3

RETRY_PERIOD = 10.0
"""s after a round of TRIES requests until the parameters that were not answered are requested again."""

SETTINGS: dict[int, AutopilotSettings] = {Autopilot.ARDUPILOT: ARDUPILOT, Autopilot.PX4: PX4}
"""MAV_AUTOPILOT -> the parameters to read. Others, our own rover among them, are not asked."""

FLIGHT_SETTINGS: dict[int, AutopilotSettings] = {Autopilot.ARDUPILOT: ARDUPILOT_COPTER, Autopilot.PX4: PX4_COPTER}
"""The same of what flies."""


def find_settings(autopilot: int, *, flies: bool) -> AutopilotSettings | None:
    """Return the parameters to read of a vehicle; None: none are known."""
    return (FLIGHT_SETTINGS if flies else SETTINGS).get(autopilot)


class SettingsCheck:
    """Reads the parameters of one vehicle and keeps the warnings. `system` and `component` are our ids.

    A parameter that was not answered is named in a warning, and requested again until it is known.
    """

    def __init__(self, settings: AutopilotSettings, system: int, component: int, *, target: tuple[int, int]) -> None:
        self._settings = settings
        self._system = system
        self._component = component
        self._target = target
        self._names = (*settings.checks, *settings.fence)
        self.restart()

    def restart(self) -> None:
        """Start again: the vehicle may have restarted with other values."""
        self._params = ParamClient(
            self._system,
            self._component,
            target_system=self._target[0],
            target_component=self._target[1],
            bytewise=self._settings.bytewise,
            repeat_after=REPEAT_AFTER,
            tries=TRIES,
        )
        self._values: dict[str, float] = {}
        self._found: dict[str, str | None] = {}
        """Parameter -> its warning; None if its value is good."""
        self._round_due = -math.inf
        self._given_up_at = math.inf
        """When the first round of requests ends."""
        self._missing: tuple[str, ...] = ()
        """Parameters that were not answered in a whole round."""
        self._asked_fence = False
        """What was not answered of the fence does not exist."""
        self._unreported = True

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line for each dangerous parameter, and one that names those that could not be read."""
        found = (warning for name, warning in self._found.items() if name not in self._settings.obeyed)
        return (*filter(None, found), *self._missing_warning())

    @property
    def findings(self) -> tuple[tuple[str, float, str], ...]:
        """Name, value and warning ("" for none) of each parameter that is known."""
        judged = ((name, value) for name, value in self._values.items() if name not in self._settings.fence)
        return tuple((name, value, self._found.get(name) or "") for name, value in judged)

    @property
    def missing(self) -> tuple[str, ...]:
        """Parameters that were not answered in a whole round."""
        return self._missing

    @property
    def obeys(self) -> str | None:
        """Warning that the vehicle obeys another ground station only; None: it obeys us, or not known."""
        return next(filter(None, map(self._found.get, self._settings.obeyed)), None)

    def pop_missing_warning(self) -> list[str]:
        """Return the warning that names the parameters that could not be read, once after each (re)start."""
        warning = self._missing_warning()
        if not warning or not self._unreported:
            return []
        self._unreported = False
        return warning

    @property
    def take_off_refusal(self) -> str:
        """Why what flies may not take off: a lost link would let it fall or fly on, or it is not known; "" if not."""
        if warning := next(iter(self.warnings), ""):
            return warning
        if self._unread(self._settings.checks):
            return "what it does without a link is being read"
        return "" if self._asked_fence or not self._unread(self._settings.fence) else "its altitude fence is being read"

    @property
    def altitude_fence(self) -> AltitudeFence | None:
        """How high the vehicle's own fence lets it fly; None: there is no such fence."""
        return self._settings.find_fence(self._values)

    @property
    def values(self) -> Mapping[str, float]:
        """The values that are known."""
        return self._values

    @property
    def link_loss_action(self) -> str | None:
        """What these settings make of a lost link; None until those that decide are known."""
        return self._settings.link_loss_action(self._values)

    @property
    def frame(self) -> int | None:
        """The frame of the vehicle, for dialects.axes.axis_map; None if it is not known or does not matter."""
        value = self._values.get(self._settings.frame)
        return None if value is None else int(value)

    def receive(self, received: Received, now: float) -> list[str]:
        """Check a PARAM_VALUE and return new warnings; other messages and other parameters are ignored."""
        message = received.message
        if not isinstance(message, ParamValue) or message.param_id not in self._names:
            return []
        self._params.receive(received, now)
        return self._check(message.param_id)

    def tick(self, now: float) -> list[Outgoing]:
        """Return the read requests that are due: one for each parameter, repeated a few times, then less often."""
        unread = self._unread(self._settings.checks if self._asked_fence else self._names)
        if now >= self._round_due and unread:
            self._round_due = now + TRIES * REPEAT_AFTER + RETRY_PERIOD
            self._given_up_at = min(self._given_up_at, now + TRIES * REPEAT_AFTER)
            for name in unread:
                self._request(name, now)
        if now >= self._given_up_at:
            self._missing, self._asked_fence = self._unread(self._settings.checks), True
        self._params.tick(now)
        return self._params.messages_to_send()

    def _unread(self, among: Iterable[str]) -> tuple[str, ...]:
        """Return the parameters that are not known by their present or former name."""
        former = self._settings.former_names
        names = (name for name in among if name not in former.values())
        return tuple(name for name in names if not {name, former.get(name)} & self._found.keys())

    def _request(self, name: str, now: float) -> None:
        self._params.read(name, now)
        if name in self._settings.former_names:
            self._params.read(self._settings.former_names[name], now)

    def _missing_warning(self) -> list[str]:
        return [f"could not read, trying again: {', '.join(self._missing)}"] if self._missing else []

    def _check(self, name: str) -> list[str]:
        param = self._params.params.get(name)
        if param is None or not math.isfinite(param.value):
            return []
        check = self._settings.checks.get(name)
        before, warning = self._found.get(name), check(param.value, self._system) if check else None
        self._values[name], self._found[name] = param.value, warning
        self._missing = tuple(each for each in self._missing if each in self._unread(self._settings.checks))
        return [warning] if warning is not None and warning != before else []
