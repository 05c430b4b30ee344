"""What ffmpeg is told: decode one source, and write pictures of one size, so many a second at most, to a pipe.

Whatever the source claims, its pictures are scaled to one size, those above MAX_PIXELS are refused before memory is
taken for them, and only the protocols and formats of its kind are opened.
"""

from __future__ import annotations

from base64 import b64encode

import msgspec

from groundstation.pictures.picture import Picture
from groundstation.video.source import SourceKind, VideoSource
from link.services.video_stamp import FIELDS, ROWS, read_stamp
from link.services.video_stream import PAYLOAD_TYPE

MAX_PIXELS = 4096 * 2304
"""Pixels of a picture of the source; 8K has four times as many."""
STAMP_ROWS = 2
"""Rows of pixels that the stamp has below the picture: half of its fields in each, 2 pixels each at least."""
MIN_STAMPED_WIDTH = FIELDS // STAMP_ROWS * 2
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
    stamped: bool = False
    """The top rows of the source are a time (link/services/video_stamp.py): STAMP_ROWS below the picture have it."""

    def with_stamp(self) -> Shape:
        """Return the shape of pictures with a stamp, as wide at least as that needs."""
        return Shape(max(self.width, MIN_STAMPED_WIDTH), self.height, self.rate, stamped=True)

    @property
    def size(self) -> int:
        """Return the bytes of a picture."""
        return 3 * self.width * (self.height + (STAMP_ROWS if self.stamped else 0))


def build_ffmpeg_command(program: str, source: VideoSource, shape: Shape, *, old: bool = False) -> list[str]:
    """Return the words of the command. `old`: a version before 5.1, which knows -fps_mode as -vsync."""
    chosen = f"select='isnan(prev_selected_t)+gte(t-prev_selected_t,{0.9 / shape.rate:.4f})'"
    filters = f"{chosen},{_split_stamp(shape) if shape.stamped else _scale(shape)}"
    return [
        program, "-nostdin", "-hide_banner", "-loglevel", "error", "-threads", "2",
        "-max_pixels", str(MAX_PIXELS), *_INPUTS[source.kind](source),
        "-map", "0:v:0", "-an", "-sn", "-dn", "-vf", filters, "-vsync" if old else "-fps_mode", "passthrough",
        "-pix_fmt", "rgb24", "-f", "rawvideo", "-flush_packets", "1", "pipe:1",
    ]  # fmt: skip


def _scale(shape: Shape) -> str:
    size = f"{shape.width}:{shape.height}"
    return f"scale={size}:force_original_aspect_ratio=decrease:flags=area,pad={size}:-1:-1,setsar=1"


def _split_stamp(shape: Shape) -> str:
    """Return the filters that scale the picture and each half of its stamp apart: a narrow row has not all fields."""
    half = f"format=rgb24,scale={shape.width}:1:flags=area,setsar=1"
    return (
        f"split=3[a][b][c];[a]crop=iw:ih-{ROWS}:0:{ROWS},{_scale(shape)},format=rgb24[p];"
        f"[b]crop=iw/2:{ROWS}:0:0,{half}[l];[c]crop=iw/2:{ROWS}:iw/2:0,{half}[r];"
        f"[p][l][r]vstack=inputs={1 + STAMP_ROWS}"
    )


def split_picture(shape: Shape, rgb: bytes) -> tuple[Picture, float | None]:
    """Return the picture in what the decoder wrote, and the s of its stamp; None without one."""
    picture = Picture(shape.width, shape.height, rgb[: 3 * shape.width * shape.height])
    if not shape.stamped:
        return picture, None
    fields = []
    for row in range(STAMP_ROWS):
        start = (shape.height + row) * shape.width
        for index in range(FIELDS // STAMP_ROWS):
            x = (2 * index + 1) * STAMP_ROWS * shape.width // (2 * FIELDS)
            fields.append(rgb[3 * (start + x) + 1])
    return picture, read_stamp(fields)


_AT_ONCE = ("-fflags", "nobuffer", "-flags", "low_delay", "-probesize", "65536", "-analyzeduration", "500000")
"""No picture waits for later ones."""


def _rtp(source: VideoSource) -> list[str]:
    session = build_session(source)
    url = f"data:application/sdp;base64,{b64encode(session.encode()).decode()}"
    return [
        "-protocol_whitelist", "data,rtp,udp", "-format_whitelist", "sdp,rtp", *_AT_ONCE,
        "-max_delay", str(RTP_WAIT), "-buffer_size", str(SOCKET_BUFFER), "-f", "sdp", "-i", url,
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


def _recorded(source: VideoSource) -> list[str]:
    """Each unit gives its picture at once: nothing is probed, and no thread waits for the next one."""
    allowed = ["-protocol_whitelist", "pipe", "-format_whitelist", "h264"]
    at_once = ["-flags", "low_delay", "-probesize", "32", "-fpsprobesize", "0", "-threads", "1"]
    return [*allowed, *at_once, "-f", "h264", "-i", source.where]


_INPUTS = {
    SourceKind.RTP: _rtp,
    SourceKind.UDP: _udp,
    SourceKind.RTSP: _rtsp,
    SourceKind.HTTP: _http,
    SourceKind.V4L2: _v4l2,
    SourceKind.FILE: _file,
    SourceKind.RECORDED: _recorded,
}
"""Kind -> what returns the options of the input."""
