"""Video sources as they are typed, and what of them reaches ffmpeg and gst-launch: no other file, no other protocol."""

from __future__ import annotations

from base64 import b64decode
from pathlib import Path

import pytest

from groundstation.video.ffmpeg_command import Shape, build_ffmpeg_command
from groundstation.video.gst_command import build_gst_command
from groundstation.video.source import ANY_ADDRESS, SourceError, SourceKind, VideoSource, parse_source

SHAPE = Shape(160, 90, 10.0)
ALLOWED = {
    "rtp:5600": ("data,rtp,udp", "sdp,rtp"),
    "udp:5600": ("udp", "h264,mpegts"),
    "rtsp://camera/live": ("rtsp,rtp,udp,tcp,tls,rtsps", "rtsp,rtp,sdp"),
    "http://camera:8080/stream": ("http,https,tls,tcp", "mov,matroska,avi,mpegts,flv,h264,hevc,mjpeg,mpjpeg,ogg"),
    "a.mp4": ("file", "mov,matroska,avi,mpegts,flv,h264,hevc,mjpeg,mpjpeg,ogg"),
}


def test_each_kind_of_source(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").touch()
    (tmp_path / "-i").touch()
    for text, source in {
        "rtp:5600": VideoSource(SourceKind.RTP, ANY_ADDRESS, 5600, "rtp:5600"),
        "udp://127.0.0.1:5601": VideoSource(SourceKind.UDP, "127.0.0.1", 5601, "udp://127.0.0.1:5601"),
        "rtsp://me:secret@10.0.0.2:8554/live": VideoSource(
            SourceKind.RTSP, "rtsp://me:secret@10.0.0.2:8554/live", name="rtsp://10.0.0.2:8554/live"
        ),
        "https://camera/mjpeg?fps=10": VideoSource(
            SourceKind.HTTP, "https://camera/mjpeg?fps=10", name="https://camera/mjpeg"
        ),
        "a.mp4": VideoSource(SourceKind.FILE, str(tmp_path / "a.mp4"), name="a.mp4"),
        "-i": VideoSource(SourceKind.FILE, str(tmp_path / "-i"), name="-i"),
        f"file:{tmp_path}/a.mp4": VideoSource(SourceKind.FILE, f"{tmp_path}/a.mp4", name=f"{tmp_path}/a.mp4"),
    }.items():
        assert parse_source(text, tmp_path) == source
    assert parse_source("v4l2:/dev/video0", tmp_path).kind is SourceKind.V4L2 if Path("/dev/video0").exists() else True


@pytest.mark.parametrize(
    "text",
    [
        "", " ", "rtp:", "rtp:0", "rtp:65536", "rtp:٥", "rtp:5600?localaddr=1", "udp:camera:5600", "udp:::1:5600",
        "udp:5600\n", "concat:a.mp4|b.mp4", "subfile,,start,0,end,9,,:a.mp4", "data:text/plain,x", "pipe:0", "fd:0",
        "lavfi:testsrc", "tcp://host:1", "srt://host:1", "file:///", "file:missing", "missing.mp4", ".", "http://",
        "http:/a/b", "http://a b/", "http://a/'x", 'rtsp://a/"', "rtsp://[::1/x", "http://host:99999/", "http://h|x/",
        "v4l2:/etc/passwd", "v4l2:/dev/video0/../../etc/passwd", "v4l2:/dev/v4l/by-id/../../sda", "v4l2:0",
        "crypto:a.mp4", "async:http://x", "x" * 3000, "http://a/\x1b[2J", "-i",
    ],
)  # fmt: skip
def test_nothing_else_is_a_source(text: str, tmp_path: Path) -> None:
    with pytest.raises(SourceError) as caught:
        parse_source(text, tmp_path)
    said = str(caught.value)
    assert said.isprintable()
    assert len(said) < 400


@pytest.mark.parametrize("text", ALLOWED)
def test_ffmpeg_opens_what_the_kind_needs_and_no_more(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.mp4").touch()
    words = build_ffmpeg_command("/bin/ffmpeg", parse_source(text, tmp_path), SHAPE)
    at = words.index("-i")
    before = words[:at]
    protocols, formats = ALLOWED[text]
    assert before[before.index("-protocol_whitelist") + 1] == protocols
    assert before[before.index("-format_whitelist") + 1] == formats
    assert int(before[before.index("-max_pixels") + 1]) < 7680 * 4320
    assert "-nostdin" in before
    assert words[at + 2 :][:3] == ["-map", "0:v:0", "-an"]
    assert words[-1] == "pipe:1"
    assert words.count("-i") == 1
    assert not words[at + 1].startswith("-")
    assert all(isinstance(word, str) for word in words)
    for other in ("hls", "concat", "dash", "lavfi"):
        assert other not in formats


def test_rtp_is_described_without_a_file(tmp_path: Path) -> None:
    words = build_ffmpeg_command("ffmpeg", parse_source("rtp:127.0.0.1:5600", tmp_path), SHAPE)
    head, _, data = words[words.index("-i") + 1].partition(",")
    assert head == "data:application/sdp;base64"
    assert b64decode(data).decode().splitlines() == [
        "v=0", "o=- 0 0 IN IP4 127.0.0.1", "s=-", "c=IN IP4 127.0.0.1", "t=0 0", "m=video 5600 RTP/AVP 96",
        "a=rtpmap:96 H264/90000",
    ]  # fmt: skip


def test_an_old_ffmpeg_gets_its_own_word(tmp_path: Path) -> None:
    source = parse_source("udp:5600", tmp_path)
    assert "-fps_mode" in build_ffmpeg_command("ffmpeg", source, SHAPE)
    old = build_ffmpeg_command("ffmpeg", source, SHAPE, old=True)
    assert old[old.index("-vsync") + 1] == "passthrough"
    assert "-fps_mode" not in old


def test_gstreamer_gets_words_that_are_values(tmp_path: Path) -> None:
    (tmp_path / 'a ! filesink "x".mp4').touch()
    words = build_gst_command("gst-launch-1.0", parse_source('a ! filesink "x".mp4', tmp_path), SHAPE)
    assert words[:4] == ["gst-launch-1.0", "-q", "filesrc", f'location="{tmp_path}/a ! filesink \\"x\\".mp4"']
    assert "sync=true" in words
    for text in [*ALLOWED][:-1]:
        words = build_gst_command("gst-launch-1.0", parse_source(text, tmp_path), SHAPE)
        assert words[-4:] == ["!", "fdsink", "fd=1", "sync=false"]
        assert "video/x-raw,format=RGB,width=160,height=90,pixel-aspect-ratio=1/1" in words
