"""Parameters that the doctor reads of a vehicle: limits and failsafes beside those of settings_check.py."""

from __future__ import annotations

from collections.abc import Mapping

from dialects import messages as m
from dialects.enums import Autopilot
from link.core import Outgoing, Received
from link.services.param.client import ParamClient

OURS = ("FS_GCS_ENABLE", "FS_GCS_TIMEOUT", "MAN_TIMEOUT", "BATT_LOW_VOLT", "MOT_TEST_MAX", "MAV_GCS_SYSID",
        *(f"MOT{number}_REVERSED" for number in range(1, 5)))  # fmt: skip
NAMES: dict[int, tuple[str, ...]] = {
    Autopilot.GENERIC: OURS,
    Autopilot.ARDUPILOT: ("FS_GCS_ENABLE", "FS_GCS_TIMEOUT", "BATT_LOW_VOLT",
                          *(f"SERVO{channel}_REVERSED" for channel in range(1, 5))),
    Autopilot.PX4: (),
}  # fmt: skip
"""MAV_AUTOPILOT -> the parameters to read. All are floats or small whole numbers cast to float."""

REPEAT_AFTER, TRIES = 1.0, 3
"""As the settings (settings_check.py). A parameter that is not answered stays unknown."""


class DoctorParams:
    """Reads the parameters of one vehicle once, while the doctor is watched. `ids` are ours."""

    def __init__(self, autopilot: int, ids: tuple[int, int], target: tuple[int, int]) -> None:
        self._names = NAMES.get(autopilot, ())
        self._ids, self._target = ids, target
        self.restart()

    def restart(self) -> None:
        """Read again: the vehicle may have restarted with other values."""
        self._requested = False
        self._params = ParamClient(
            *self._ids, target_system=self._target[0], target_component=self._target[1], repeat_after=REPEAT_AFTER,
            tries=TRIES,
        )  # fmt: skip

    @property
    def values(self) -> Mapping[str, float]:
        """The values that are known."""
        return {name: param.value for name, param in self._params.params.items()}

    def receive(self, received: Received, now: float) -> None:
        """Handle a PARAM_VALUE, also one that another program has asked for."""
        if isinstance(received.message, m.ParamValue) and received.message.param_id in self._names:
            self._params.receive(received, now)

    def tick(self, now: float, *, watched: bool) -> list[Outgoing]:
        """Return the read requests that are due."""
        if watched and not self._requested:
            self._requested = True
            for name in self._names:
                self._params.read(name, now)
        self._params.tick(now)
        return self._params.messages_to_send()
