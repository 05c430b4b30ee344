"""What the programs are told that capture and encode: words of a command line, never a shell."""

from __future__ import annotations

from collections.abc import Callable

from link.services.video_stamp import ROWS, draw_stamp
from link.services.video_stream import PAYLOAD_TYPE
from vehicle.camera.settings import CameraSettings

PACKET = 1200
"""Bytes of an RTP packet: it fits into each path of the internet."""
KEY_PICTURES = 0.5
"""s between whole pictures: who joins, or has lost a packet, waits so long at most."""


def build_capture(settings: CameraSettings) -> list[str] | None:
    """Return the words of the program that writes pictures to its standard output; None: we draw them."""
    build = CAPTURES.get(settings.kind)
    return build(settings) if build is not None else None


def _rpicam(settings: CameraSettings) -> list[str]:
    return [
        "rpicam-vid", "--timeout", "0", "--nopreview", "--codec", "yuv420", "--width", str(settings.width),
        "--height", str(settings.height), "--framerate", str(settings.rate), "--flush", "--output", "-",
    ]  # fmt: skip


def _v4l2(settings: CameraSettings) -> list[str]:
    size = f"{settings.width}:{settings.height}"
    return [
        "ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-fflags", "nobuffer",
        "-f", "v4l2", "-framerate", str(settings.rate), "-video_size", f"{settings.width}x{settings.height}",
        "-i", settings.device, "-vf", f"fps={settings.rate},scale={size}", "-pix_fmt", "yuv420p",
        "-f", "rawvideo", "-flush_packets", "1", "pipe:1",
    ]  # fmt: skip


CAPTURES: dict[str, Callable[[CameraSettings], list[str]]] = {
    "rpicam": _rpicam,
    "v4l2": _v4l2,
    "command": lambda settings: list(settings.command),
}
"""Kind of camera -> the words of its program."""


def build_encoder(settings: CameraSettings, port: int) -> list[str]:
    """Return the words of ffmpeg: pictures from its standard input, H.264 in RTP to a port of this machine."""
    to = f"rtp://127.0.0.1:{port}?rtcpport={port}&pkt_size={PACKET}"
    out = ["-an", "-bsf:v", "dump_extra", "-payload_type", str(PAYLOAD_TYPE), "-f", "rtp", "-sdp_file", "/dev/null", to]
    head = ["ffmpeg", "-hide_banner", "-loglevel", "error", "-fflags", "nobuffer"]
    if settings.kind == "command":
        return [*head, "-probesize", "32768", "-f", "h264", "-i", "pipe:0", "-c:v", "copy", *out]
    rate, bits = str(settings.rate), f"{settings.bitrate}k"
    quick = ["-preset", "ultrafast", "-tune", "zerolatency"] if settings.encoder == "libx264" else []
    return [
        *head, "-probesize", "32", "-f", "rawvideo", "-pixel_format", find_format(settings),
        "-video_size", f"{settings.width}x{settings.height + ROWS}", "-framerate", rate, "-i", "pipe:0",
        "-c:v", settings.encoder, *quick, "-pix_fmt", "yuv420p", "-g", str(max(1, round(KEY_PICTURES * settings.rate))),
        "-b:v", bits, "-maxrate", bits, "-bufsize", f"{max(1, settings.bitrate // 2)}k", "-bf", "0", *out,
    ]  # fmt: skip


def find_format(settings: CameraSettings) -> str:
    """Return the pixel format of the pictures that are stamped."""
    return "gbrp" if settings.kind == "simulated" else "yuv420p"


def picture_size(settings: CameraSettings) -> int:
    """Return the bytes of a picture without its stamp."""
    pixels = settings.width * settings.height
    return 3 * pixels if settings.kind == "simulated" else pixels * 3 // 2


def stamp_picture(settings: CameraSettings, picture: bytes, seconds: float) -> bytes:
    """Return a picture with its time in ROWS more rows at the top of each plane."""
    width, pixels = settings.width, settings.width * settings.height
    stamp = draw_stamp(seconds, width) * ROWS
    if settings.kind == "simulated":
        return b"".join(stamp + picture[plane * pixels : (plane + 1) * pixels] for plane in range(3))
    grey = b"\x80" * (width // 2 * (ROWS // 2))
    quarter = pixels // 4
    chroma = (picture[pixels : pixels + quarter], picture[pixels + quarter : pixels + 2 * quarter])
    return b"".join((stamp, picture[:pixels], grey, chroma[0], grey, chroma[1]))
