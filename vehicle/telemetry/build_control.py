"""Builds the messages about who is in control: CONTROL_STATUS by system id, ROVER_CONTROL by program."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import ControlFlag
from vehicle.telemetry.view import TelemetryView

SYSTEM_MANAGER, TAKEOVER_ALLOWED = 1, 2
"""GCS_CONTROL_STATUS_FLAGS"""


def control_status(view: TelemetryView) -> m.Message:
    """Build CONTROL_STATUS: the ground station in control."""
    ownership = view.control.ownership
    flags = SYSTEM_MANAGER | (TAKEOVER_ALLOWED if ownership.takeover_allowed else 0)
    return m.ControlStatus(flags=flags, gcs_main=ownership.owner, gcs_secondary=[0] * 10)


def rover_control(view: TelemetryView) -> m.Message:
    """Build ROVER_CONTROL: the program in control."""
    session, system, component, flags = control_key(view)
    return m.RoverControl(session, system, component, flags)


def control_key(view: TelemetryView) -> tuple[int, int, int, int]:
    """Return the session, system id and component id of the driver (0, 0, 0 without one) and its ControlFlag."""
    ownership = view.control.ownership
    flags = ControlFlag.TAKEOVER_ALLOWED if ownership.takeover_allowed else ControlFlag(0)
    driver = ownership.driver
    if driver is None:
        return 0, 0, 0, int(flags)
    if driver.is_barred(view.now):
        flags |= ControlFlag.CLASH
    if ownership.is_silent(view.now):
        flags |= ControlFlag.SILENT
    return driver.session.id if driver.session else 0, *driver.conversation.ids, int(flags)
