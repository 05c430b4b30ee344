"""Who is in control, as the vehicle reports it: CONTROL_STATUS by system id, ROVER_CONTROL by program."""

from __future__ import annotations

import msgspec

from dialects.enums import ControlFlag
from dialects.messages import ControlStatus, RoverControl


class ControlReport(msgspec.Struct):
    """The newest report of one vehicle."""

    driver: int | None = None
    """System id of the ground station in control, 0: none; None: the vehicle does not tell."""
    component: int | None = None
    """Its component id; None: not reported."""
    session: int | None = None
    """Its session, 0: it has none; None: not reported."""
    silent: bool = False
    """It is silent: another program with its ids takes over with its next demand or command."""
    clash: bool = False
    """Two programs with its ids cannot be told apart, and none of them drives."""

    def handle_control_status(self, message: ControlStatus) -> None:
        """Handle a CONTROL_STATUS; of another driver the program is not known yet."""
        if message.gcs_main != self.driver:
            self.component = self.session = None
            self.silent = self.clash = False
        self.driver = message.gcs_main

    def handle_rover_control(self, message: RoverControl) -> None:
        """Handle a ROVER_CONTROL."""
        self.driver = message.driver_system
        self.component, self.session = message.driver_component, message.session_id
        self.silent = bool(message.flags & ControlFlag.SILENT)
        self.clash = bool(message.flags & ControlFlag.CLASH)

    def is_program(self, ids: tuple[int, int], session: int, *, accepted: bool) -> bool:
        """Return whether the driver is the program with these ids and this session.

        `accepted`: the vehicle has accepted arming or a request for control from it. That decides for a vehicle that
        does not tell, and for a driver that has no session, which may be another program with the same ids.
        """
        if self.driver is None or (self.driver == ids[0] and self.session == 0):
            return accepted
        return self.driver == ids[0] and self.component in (None, ids[1]) and self.session in (None, session)
