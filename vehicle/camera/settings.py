"""Settings of the camera: the section [camera] of rover.toml."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

CameraKind = Literal["none", "rpicam", "v4l2", "command", "simulated"]
Encoder = Literal["libx264", "h264_v4l2m2m"]


class CameraSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The camera, which streams H.264 in RTP to ground stations while one of them watches. It needs ffmpeg."""

    kind: CameraKind = "none"
    """none; rpicam (rpicam-vid of Raspberry Pi OS); v4l2 (a USB camera); command (see below). docs/camera.md"""
    device: str = "/dev/video0"
    """Camera of v4l2."""
    command: tuple[str, ...] = ()
    """Words of a program that writes H.264 to its standard output, for kind = "command"; no shell."""
    width: Annotated[int, msgspec.Meta(ge=96, le=1920, multiple_of=2)] = 640
    height: Annotated[int, msgspec.Meta(ge=64, le=1080, multiple_of=2)] = 360
    """Pixels of a picture."""
    rate: Annotated[int, msgspec.Meta(ge=1, le=60)] = 15
    """Pictures a second."""
    bitrate: Annotated[int, msgspec.Meta(ge=50, le=20_000)] = 1000
    """kbit/s of one copy of each packet."""
    copies: Annotated[int, msgspec.Meta(ge=1, le=3)] = 2
    """How often each packet is sent: 2 or 3 for networks that lose some, such as Wi-Fi; 1 where each byte costs."""
    port: Annotated[int, msgspec.Meta(ge=1024, le=65534)] = 5600
    """UDP port of the ground station. QGroundControl listens on 5600."""
    encoder: Encoder = "libx264"
    """Encoder of ffmpeg; h264_v4l2m2m is the hardware of a Raspberry Pi 4 and older."""


SIMULATED_CAMERA = CameraSettings(kind="simulated", width=320, height=180, rate=15, bitrate=600)


def find_problems(settings: CameraSettings) -> list[str]:
    """Return one line for each contradiction."""
    if settings.kind == "simulated":
        return ["camera.kind: simulated is for `mavhelm vehicle --sim --camera`; use rpicam, v4l2 or command"]
    if settings.kind == "command" and not settings.command:
        return ['camera.command: missing; give the words of the program, e.g. ["rpicam-vid", "-t", "0", "-o", "-"]']
    return []
