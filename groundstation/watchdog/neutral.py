"""Neutral frames in the name of the station: each vehicle in its own axes, with numbers that follow the station's."""

from __future__ import annotations

from dialects import codec
from dialects.axes import build_neutral
from dialects.enums import OperatorFlag
from dialects.messages import INVALID_AXIS, UINT16_MAX, ManualControl, Message, RoverOperatorPresence, boot_ms
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.watchdog.report import DemandRoute
from link.protocol.signing_guard import SigningContext
from link.signing.signing import FrameSigner, Signing

SEQUENCE_LEAD = 40
"""Packet sequence numbers left out: more than a station sends between two reports, and more than LATE_WINDOW
(link/protocol/sequence.py). So the frames of a station that goes on are neither late nor a clash with these; the
vehicle knows both by their session."""


class _Signer:
    """Signs as the station did on one route."""

    def __init__(self, signing: Signing, way: SigningContext) -> None:
        self._signing = signing
        self._way = way
        self._signer = FrameSigner(signing.clock)

    def sign(self, number: int, payload: bytes, sequence: int, ids: tuple[int, int], now: float) -> bytes | None:
        """Return a signed frame; None if the station's key has gone."""
        key = self._signing.hash_of(self._signing.ring.find(self._way.key))
        if key is None:
            return None
        frame = codec.frame_to_sign(number, payload, sequence, *ids)
        return self._signer.sign(frame, key, self._way.link_id, self._way.lead, now)


class NeutralFrames:
    """The frames for one vehicle on one route. `ids` are those of the station, `signing` what it signs with."""

    def __init__(
        self, vehicle: WatchdogTarget, ids: tuple[int, int], route: DemandRoute, signing: Signing | None = None
    ) -> None:
        self._vehicle = vehicle
        self._ids = ids
        self._sequence = route.sequence + SEQUENCE_LEAD
        self._clock = 0
        self._frame = codec.frame_v1 if route.version_1 and vehicle.session is None else codec.frame
        self._signer = None if signing is None or route.signing is None else _Signer(signing, route.signing)

    def next_frame(self, now: float) -> bytes:
        """Return the next frame."""
        message = self._build(now)
        self._sequence += 1
        number, payload, sequence = type(message).id, codec.encode_payload(message), self._sequence & 0xFF
        frame = None if self._signer is None else self._signer.sign(number, payload, sequence, self._ids, now)
        return frame or self._frame(number, payload, sequence, *self._ids)

    def _build(self, now: float) -> Message:
        vehicle = self._vehicle
        neutral = build_neutral(vehicle.system, vehicle.autopilot, vehicle.kind)
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
