"""Video sources as a person writes them: checked before a program of others sees them.

ffmpeg reads much more than video: `concat:` and playlists open other files, `subfile:` and `data:` too. So a source is
one of KINDS, and nothing else; the decoder is also told which protocols and formats it may open (ffmpeg_command.py).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from enum import StrEnum
from ipaddress import ip_address
from pathlib import Path
from urllib.parse import urlsplit

import msgspec


class SourceError(Exception):
    """A source that cannot be opened; the text is one line for the user."""


class SourceKind(StrEnum):
    """How the video comes."""

    RTP = "rtp"
    UDP = "udp"
    RTSP = "rtsp"
    HTTP = "http"
    V4L2 = "v4l2"
    FILE = "file"
    RECORDED = "recorded"
    """H.264 that we write to the decoder's standard input; nobody can name it."""


class VideoSource(msgspec.Struct, frozen=True):
    """A checked source."""

    kind: SourceKind
    where: str
    """A URL, an absolute path, or the address to listen on."""
    port: int = 0
    """To listen on."""
    name: str = ""
    """For the screen: without a password."""

    @property
    def ends(self) -> bool:
        """Return whether it is a recording, whose end is no fault."""
        return self.kind is SourceKind.FILE


RECORDED = VideoSource(SourceKind.RECORDED, "pipe:0", name="recorded pictures")
MAX_LENGTH = 2000
"""Characters of a source."""
SHAPES = "rtp:PORT, udp:PORT, rtsp://HOST/PATH, http://HOST/PATH, v4l2:/dev/videoN or a file"
ANY_ADDRESS = "0.0.0.0"
_DEVICE = re.compile(r"/dev/(?:video\d{1,3}|v4l/by-(?:id|path)/[\w.:+-]+)", re.ASCII)


def parse_source(text: str, folder: Path) -> VideoSource:
    """Return the source that a text means; names of files are relative to the folder. Raises SourceError."""
    if not text or len(text) > MAX_LENGTH or not text.isprintable():
        raise SourceError(f"{_shown(text)} is no video source: give {SHAPES}")
    scheme, colon, rest = text.partition(":")
    if colon and (parse := KINDS.get(scheme.lower())) is not None:
        return parse(text, rest)
    if colon and "/" not in scheme and not (folder / text).exists():
        raise SourceError(f"{_shown(text)}: {scheme!r} is no kind of video source: give {SHAPES}")
    return _parse_file(text, text, folder)


def _parse_port(kind: SourceKind) -> Callable[[str, str], VideoSource]:
    """Return what reads PORT or ADDRESS:PORT of this machine."""

    def parse(text: str, rest: str) -> VideoSource:
        address, _, port = rest.removeprefix("//").rpartition(":")
        try:
            listened = str(ip_address(address)) if address else ANY_ADDRESS
        except ValueError:
            listened = ""
        if not listened or ":" in listened or not re.fullmatch(r"[1-9]\d{0,4}", port, re.ASCII) or int(port) > 65535:
            raise SourceError(
                f"{_shown(text)}: give a port of this machine from 1 to 65535, e.g. {kind}:5600,"
                f" or its own IPv4 address, e.g. {kind}:127.0.0.1:5600"
            )
        return VideoSource(kind, listened, int(port), name=text)

    return parse


def _parse_url(kind: SourceKind) -> Callable[[str, str], VideoSource]:
    """Return what reads a URL."""

    def parse(text: str, rest: str) -> VideoSource:
        try:
            parts = urlsplit(text)
            host, port = parts.hostname, parts.port
        except ValueError:
            host, port = None, None
        if not host or not rest.startswith("//") or not text.isascii() or re.search(r"[\s\"'\\<>|]", text):
            raise SourceError(f"{_shown(text)}: give a URL as {kind}://HOST:PORT/PATH")
        shown = f"{parts.scheme}://{host}{f':{port}' if port else ''}{parts.path}"
        return VideoSource(kind, text, name=shown)

    return parse


def _parse_device(text: str, rest: str) -> VideoSource:
    if not _DEVICE.fullmatch(rest) or ".." in rest:
        raise SourceError(f"{_shown(text)}: give a camera of this machine, e.g. v4l2:/dev/video0")
    if not Path(rest).exists():
        raise SourceError(f"{rest} does not exist: connect the camera; `ls /dev/video*` shows those there are")
    return VideoSource(SourceKind.V4L2, rest, name=text)


def _parse_file(text: str, name: str, folder: Path) -> VideoSource:
    path = (folder / name).absolute()
    try:
        if not path.is_file():
            why = "is no file" if path.exists() else "does not exist"
            raise SourceError(f"{_shown(text)} {why}: give {SHAPES}")
    except OSError as error:
        raise SourceError(f"{_shown(text)}: {error.strerror}") from error
    return VideoSource(SourceKind.FILE, str(path), name=name)


KINDS: dict[str, Callable[[str, str], VideoSource]] = {
    "rtp": _parse_port(SourceKind.RTP),
    "udp": _parse_port(SourceKind.UDP),
    "rtsp": _parse_url(SourceKind.RTSP),
    "rtsps": _parse_url(SourceKind.RTSP),
    "http": _parse_url(SourceKind.HTTP),
    "https": _parse_url(SourceKind.HTTP),
    "v4l2": _parse_device,
    "file": lambda text, rest: _parse_file(text, rest.removeprefix("//"), Path("/")),
}
"""Word before the colon -> what reads the whole text and what is behind the colon."""


def _shown(text: str) -> str:
    return repr(text if len(text) <= 60 else f"{text[:57]}...")
