"""What ffmpeg is told: decode one source, and write pictures of one size, so many a second at most, to a pipe.

Whatever the source claims, its pictures are scaled to one size, those above MAX_PIXELS are refused before memory is
taken for them, and only the protocols and formats of its kind are opened.
"""

from __future__ import annotations

from base64 import b64encode

import msgspec

from groundstation.video.source import Kind, VideoSource

MAX_PIXELS = 4096 * 2304
"""Pixels of a picture of the source; 8K has four times as many."""
PAYLOAD_TYPE = 96
"""Of H.264 in RTP, as rpicam, GStreamer and ffmpeg send it."""
RTP_WAIT = 50_000
"""us that a packet that overtakes another one waits for it."""
READ_TIMEOUT = 10_000_000
"""us without data after which a connection is given up."""
SOCKET_BUFFER = 1 << 20
"""Bytes: a picture of H.264 comes in a burst."""
CONTAINERS = "mov,matroska,avi,mpegts,flv,h264,hevc,mjpeg,mpjpeg,ogg"
"""Formats of files and of HTTP. Playlists (hls, concat, dash, sdp) are not among them: they open other files."""


class Shape(msgspec.Struct, frozen=True):
    """What the decoder writes."""

    width: int
    height: int
    rate: float
    """Pictures a second at most."""

    @property
    def size(self) -> int:
        """Return the bytes of a picture."""
        return 3 * self.width * self.height


def build_ffmpeg_command(program: str, source: VideoSource, shape: Shape, *, old: bool = False) -> list[str]:
    """Return the words of the command. `old`: a version before 5.1, which knows -fps_mode as -vsync."""
    size = f"{shape.width}:{shape.height}"
    filters = (
        f"select='isnan(prev_selected_t)+gte(t-prev_selected_t,{0.9 / shape.rate:.4f})',"
        f"scale={size}:force_original_aspect_ratio=decrease:flags=area,pad={size}:-1:-1,setsar=1"
    )
    return [
        program, "-nostdin", "-hide_banner", "-loglevel", "error", "-threads", "2",
        "-max_pixels", str(MAX_PIXELS), *_INPUTS[source.kind](source),
        "-map", "0:v:0", "-an", "-sn", "-dn", "-vf", filters, "-vsync" if old else "-fps_mode", "passthrough",
        "-pix_fmt", "rgb24", "-f", "rawvideo", "-flush_packets", "1", "pipe:1",
    ]  # fmt: skip


_AT_ONCE = ("-fflags", "nobuffer", "-flags", "low_delay", "-probesize", "65536", "-analyzeduration", "500000")
"""No picture waits for later ones."""


def _rtp(source: VideoSource) -> list[str]:
    session = build_session(source)
    url = f"data:application/sdp;base64,{b64encode(session.encode()).decode()}"
    return [
        "-protocol_whitelist", "data,rtp,udp", "-format_whitelist", "sdp,rtp", *_AT_ONCE,
        "-max_delay", str(RTP_WAIT), "-f", "sdp", "-i", url,
    ]  # fmt: skip


def build_session(source: VideoSource) -> str:
    """Return the description (RFC 8866) of H.264 in RTP that comes to a port of this machine."""
    lines = (
        "v=0", "o=- 0 0 IN IP4 127.0.0.1", "s=-", f"c=IN IP4 {source.where}", "t=0 0",
        f"m=video {source.port} RTP/AVP {PAYLOAD_TYPE}", f"a=rtpmap:{PAYLOAD_TYPE} H264/90000",
    )  # fmt: skip
    return "".join(f"{line}\r\n" for line in lines)


def _udp(source: VideoSource) -> list[str]:
    url = f"udp://{source.where}:{source.port}?overrun_nonfatal=1&fifo_size=5000&buffer_size={SOCKET_BUFFER}"
    return ["-protocol_whitelist", "udp", "-format_whitelist", "h264,mpegts", *_AT_ONCE, "-i", url]


def _rtsp(source: VideoSource) -> list[str]:
    allowed = "rtsp,rtp,udp,tcp,tls,rtsps"
    return [
        "-protocol_whitelist", allowed, "-format_whitelist", "rtsp,rtp,sdp", *_AT_ONCE, "-max_delay", str(RTP_WAIT),
        "-rtsp_flags", "prefer_tcp", "-timeout", str(READ_TIMEOUT), "-f", "rtsp", "-i", source.where,
    ]  # fmt: skip


def _http(source: VideoSource) -> list[str]:
    allowed = ["-protocol_whitelist", "http,https,tls,tcp", "-format_whitelist", CONTAINERS]
    return [*allowed, *_AT_ONCE, "-rw_timeout", str(READ_TIMEOUT), "-i", source.where]


def _v4l2(source: VideoSource) -> list[str]:
    return ["-protocol_whitelist", "file", "-format_whitelist", "v4l2,video4linux2", "-f", "v4l2", "-i", source.where]


def _file(source: VideoSource) -> list[str]:
    allowed = ["-protocol_whitelist", "file", "-format_whitelist", CONTAINERS]
    return [*allowed, "-re", "-i", f"file:{source.where}"]


_INPUTS = {
    Kind.RTP: _rtp,
    Kind.UDP: _udp,
    Kind.RTSP: _rtsp,
    Kind.HTTP: _http,
    Kind.V4L2: _v4l2,
    Kind.FILE: _file,
}
"""Kind -> what returns the options of the input."""
