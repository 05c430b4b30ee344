"""What the rows of `mavhelm bridge doctor` judge."""

from __future__ import annotations

import msgspec

from link.endpoint import Endpoint


class Source(msgspec.Struct, frozen=True):
    """One system and component that was heard on an endpoint."""

    system: int
    component: int
    frames: int
    kind: int | None = None
    """MAV_TYPE of its HEARTBEAT; None if none arrived."""
    autopilot: int | None = None
    """MAV_AUTOPILOT of its HEARTBEAT."""
    signed: bool = False
    """Its newest frame was signed."""


class ForwardRoute(msgspec.Struct, frozen=True):
    """Where the frames of one source would go."""

    system: int
    component: int
    broadcasts: tuple[str, ...]
    """Endpoints that its broadcasts would go to."""
    also_on: tuple[str, ...]
    """Other endpoints on which the same system and component was heard."""


class TrafficSample(msgspec.Struct, frozen=True):
    """What arrived on one endpoint."""

    received: int = 0
    """Bytes."""
    addresses: int = 0
    """Addresses that they came from."""
    frames: int = 0
    """Verified ones."""
    crc_errors: int = 0
    noise: int = 0
    """Bytes outside of any frame."""
    unknown: int = 0
    """Frames with an id outside the dialect."""
    unknown_ids: tuple[int, ...] = ()
    mismatched: tuple[str, ...] = ()
    """Messages that arrive complete, with the checksum of another definition."""
    sources: tuple[Source, ...] = ()


class EndpointFacts(msgspec.Struct, frozen=True):
    """One endpoint after listening."""

    endpoint: Endpoint
    seconds: float
    """Time of listening."""
    problem: str = ""
    """Why it does not open or work, and what to do; without the name of the endpoint."""
    holders: tuple[str, ...] = ()
    """Programs that have its port."""
    heard: TrafficSample = TrafficSample()
    routes: tuple[ForwardRoute, ...] = ()
    alone: bool = False
    """No other endpoint was given."""
    others_heard: bool = False
    """Frames arrived on another endpoint."""
