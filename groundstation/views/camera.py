"""The view of the vehicle's camera: where its stream comes, for the screen that decodes it."""

from __future__ import annotations

from groundstation.views.base import View, ViewRequest


class CameraRequest(ViewRequest, frozen=True):
    """The stream of the selected vehicle's camera, which runs as long as this is requested."""

    port: int = 0
    """UDP port of loopback at which a decoder of the screen listens; 0: none does."""


class CameraView(View, frozen=True):
    """What the vehicle has announced."""

    system: int
    port: int = 0
    """UDP port of this machine to which it sends H.264 in RTP; 0: not known."""
    stamped: bool = False
    """Its pictures have their time in the top rows."""
    problem: str = ""
    """Why there is no stream, in one line."""
    offset: float | None = None
    """s by which the clock of the vehicle is ahead of ours; None: not known."""
    offset_error: float = 0.0
    """s by which that may be wrong."""
    log: str = ""
    """In a replay: path of the telemetry log, beside which pictures may be recorded; no stream comes then."""
    at: float = 0.0
    """In a replay: the moment that is shown, by the recorded clock, s since 1970."""
