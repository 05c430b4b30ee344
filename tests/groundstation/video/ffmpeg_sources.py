"""ffmpeg's test picture as a camera: a process that sends it, and the mark of tests that need ffmpeg."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

NEEDS_FFMPEG = pytest.mark.skipif(
    shutil.which("ffmpeg") is None and "MAVHELM_CI" not in os.environ, reason="ffmpeg is not installed"
)
H264 = ["-c:v", "libx264", "-preset", "ultrafast", "-tune", "zerolatency", "-g", "10", "-bsf:v", "dump_extra"]


def outputs(kind: str, port: int) -> list[str]:
    """What ffmpeg is told to send, for our source KIND:127.0.0.1:PORT or http://127.0.0.1:PORT/."""
    return {
        "udp": [*H264, "-f", "h264", f"udp://127.0.0.1:{port}?pkt_size=1300"],
        "rtp": [*H264, "-f", "rtp", "-payload_type", "96", f"rtp://127.0.0.1:{port}"],
        "http": ["-c:v", "mjpeg", "-f", "mpjpeg", "-listen", "1", f"http://127.0.0.1:{port}/"],
    }[kind]


def words(picture: str, *output: str) -> list[str]:
    quiet = ["ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "quiet", "-threads", "1"]
    return [*quiet, "-re", "-f", "lavfi", "-i", picture, *output]


@contextmanager
def camera(kind: str, port: int, picture: str = "testsrc2=size=320x180:rate=15") -> Iterator[subprocess.Popen[bytes]]:
    """A camera that sends within the block."""
    process = subprocess.Popen(
        words(picture, *outputs(kind, port)), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()


def record(path: Path, picture: str, *output: str) -> Path:
    """Write a recording of a test picture at once."""
    command = [each for each in words(picture, *output, str(path)) if each != "-re"]
    subprocess.run(command, stdin=subprocess.DEVNULL, check=True)
    return path
