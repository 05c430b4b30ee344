"""What gst-launch-1.0 is told, where ffmpeg is missing: the same pictures on the same pipe.

Each word of a pipeline is an argument of its own, and gst-launch reads "name=value" in one: a value with a blank or an
exclamation mark in quotes stays one word. groundstation/video/source.py lets no quotes into a URL.
"""

from __future__ import annotations

from collections.abc import Callable

from groundstation.video.ffmpeg_command import SOCKET_BUFFER, Shape
from groundstation.video.source import SourceKind, VideoSource
from link.services.video_stream import PAYLOAD_TYPE

_DECODE = ["!", "decodebin"]


def build_gst_command(program: str, source: VideoSource, shape: Shape) -> list[str]:
    """Return the words of the command."""
    caps = f"video/x-raw,format=RGB,width={shape.width},height={shape.height},pixel-aspect-ratio=1/1"
    drawn = [
        "!", "queue", "leaky=downstream", "max-size-buffers=2", *_rate(source, shape),
        "!", "videoconvert", "!", "videoscale", "add-borders=true", "!", caps, "!", "fdsink", "fd=1", _sync(source),
    ]  # fmt: skip
    return [program, "-q", *_INPUTS[source.kind](source), *drawn]


def _rate(source: VideoSource, shape: Shape) -> list[str]:
    """Return what leaves pictures out. videorate aborts at those without a duration, as cameras send them."""
    return ["!", "videorate", "drop-only=true", f"max-rate={max(1, round(shape.rate))}"] if source.ends else []


def _sync(source: VideoSource) -> str:
    """Return whether pictures wait for their time: those of a file only."""
    return f"sync={'true' if source.ends else 'false'}"


def _rtp(source: VideoSource) -> list[str]:
    caps = f"application/x-rtp,media=video,clock-rate=90000,encoding-name=H264,payload={PAYLOAD_TYPE}"
    return [*_udpsrc(source), "!", caps, "!", "rtpjitterbuffer", "latency=50", "!", "rtph264depay", *_DECODE]


def _udp(source: VideoSource) -> list[str]:
    return [*_udpsrc(source), *_DECODE]


def _udpsrc(source: VideoSource) -> list[str]:
    return ["udpsrc", f"address={source.where}", f"port={source.port}", f"buffer-size={SOCKET_BUFFER}"]


def _rtsp(source: VideoSource) -> list[str]:
    return ["rtspsrc", f"location={_quoted(source)}", "latency=50", *_DECODE]


def _http(source: VideoSource) -> list[str]:
    """MJPEG: decodebin does not find the parts of its multipart stream."""
    return ["souphttpsrc", f"location={_quoted(source)}", "timeout=10", "!", "multipartdemux", "!", "jpegdec"]


def _v4l2(source: VideoSource) -> list[str]:
    return ["v4l2src", f"device={source.where}", *_DECODE]


def _file(source: VideoSource) -> list[str]:
    return ["filesrc", f"location={_quoted(source)}", *_DECODE]


def _quoted(source: VideoSource) -> str:
    text = source.where.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{text}"'


_INPUTS: dict[SourceKind, Callable[[VideoSource], list[str]]] = {
    SourceKind.RTP: _rtp,
    SourceKind.UDP: _udp,
    SourceKind.RTSP: _rtsp,
    SourceKind.HTTP: _http,
    SourceKind.V4L2: _v4l2,
    SourceKind.FILE: _file,
    SourceKind.RECORDED: lambda source: ["fdsrc", "fd=0", "!", "h264parse", *_DECODE],
}
"""Kind -> what returns the elements of the input."""
