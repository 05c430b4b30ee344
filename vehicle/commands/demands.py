"""MANUAL_CONTROL, RC_CHANNELS_OVERRIDE and ROVER_OPERATOR_PRESENCE: the demands of the ground station in control."""

from __future__ import annotations

from dialects import messages as m
from link.core import Received
from vehicle.commands.access import Access
from vehicle.commands.buttons import Buttons
from vehicle.commands.context import COMPONENT, Context
from vehicle.commands.inbound import Effect, InboundMessage, InboundTable


class DemandMessages:
    """Passes demands to Control, and the buttons of MANUAL_CONTROL to their functions."""

    def __init__(self, context: Context) -> None:
        self.buttons = Buttons(context)
        self._control = context.control

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        return (
            InboundMessage(m.ManualControl, Access.DRIVER, "demand by axes; buttons by BTNn_FUNCTION",
                           self._handle_manual_control, Effect.DEMAND),
            InboundMessage(m.RcChannelsOverride, Access.DRIVER, "demand by channels 1 (steering) and 3 (throttle)",
                           self._handle_rc_override, Effect.DEMAND),
            InboundMessage(m.RoverOperatorPresence, Access.DRIVER,
                           "demand by axes with the proof of its age; without axes: how current the next demand is",
                           self._handle_operator_presence, Effect.DEMAND),
        )  # fmt: skip

    def _handle_manual_control(self, received: Received, message: m.ManualControl, now: float) -> None:
        self.buttons.handle_manual_control(received, message, now)
        self._control.handle_manual_control(received, message, now)

    def _handle_operator_presence(self, received: Received, message: m.RoverOperatorPresence, now: float) -> None:
        self._control.handle_operator_presence(received, message, now)

    def _handle_rc_override(self, received: Received, message: m.RcChannelsOverride, now: float) -> None:
        if message.target_component in (0, COMPONENT):
            self._control.handle_rc_override(received, message, now)
