"""Neutral frames in the name of the station: each vehicle in its own axes, with numbers that follow the station's."""

from __future__ import annotations

from dialects import codec
from dialects.axes import NEUTRAL, axis_map, build_manual_control
from dialects.enums import OperatorFlag
from dialects.messages import INVALID_AXIS, UINT16_MAX, ManualControl, Message, RoverOperatorPresence, boot_ms
from groundstation.station.driving.driven import DrivenVehicle
from groundstation.watchdog.report import DemandRoute
from link.signing.signature import SecretHash
from link.signing.signing import FrameSigner, Signing

SEQUENCE_LEAD = 40
"""Packet sequence numbers left out: more than a station sends between two reports, and more than LATE_WINDOW
(link/protocol/sequence.py). So the frames of a station that goes on are neither late nor a clash with these; the
vehicle knows both by their session."""


class NeutralFrames:
    """The frames for one vehicle on one route. `ids` are those of the station, `signing` what it signs with."""

    def __init__(
        self, vehicle: DrivenVehicle, ids: tuple[int, int], route: DemandRoute, signing: Signing | None = None
    ) -> None:
        self._vehicle = vehicle
        self._ids = ids
        self._sequence = route.sequence + SEQUENCE_LEAD
        self._clock = 0
        self._way = route.signing
        self._signing = signing
        self._signer = FrameSigner(signing.clock) if signing is not None else None

    def next_frame(self, now: float) -> bytes:
        """Return the next frame."""
        message = self._build(now)
        self._sequence += 1
        number, payload, sequence = type(message).id, codec.encode_payload(message), self._sequence & 0xFF
        key = self._find_key()
        if key is None or self._way is None or self._signer is None:
            return codec.frame(number, payload, sequence, *self._ids)
        frame = codec.frame_to_sign(number, payload, sequence, *self._ids)
        return self._signer.sign(frame, key, self._way.link_id, self._way.lead, now)

    def _find_key(self) -> SecretHash | None:
        if self._signing is None or self._way is None:
            return None
        return self._signing.hash_of(self._signing.ring.find(self._way.key))

    def _build(self, now: float) -> Message:
        vehicle = self._vehicle
        neutral = build_manual_control(NEUTRAL, vehicle.system, axis_map(vehicle.autopilot))
        return neutral if vehicle.session is None else self._build_proof(vehicle.session, neutral, now)

    def _build_proof(self, session: int, neutral: ManualControl, now: float) -> RoverOperatorPresence:
        """Build a neutral demand of the station's session; it reports that there is no operator.

        The vehicle stops for the newest demand of a session, however old the time is that it echoes.
        """
        self._clock = max(self._clock + 1, boot_ms(now))
        return RoverOperatorPresence(
            target_system=self._vehicle.system,
            target_component=self._vehicle.component,
            time_boot_ms=self._clock & 0xFFFFFFFF,
            echo_time_boot_ms=self._vehicle.boot_time,
            session_id=session,
            input_count=0,
            last_input_age_ms=UINT16_MAX,
            flags=OperatorFlag.AXES | OperatorFlag.INPUT_LOST,
            x=neutral.x,
            y=INVALID_AXIS,
            z=INVALID_AXIS,
            r=neutral.r,
        )
