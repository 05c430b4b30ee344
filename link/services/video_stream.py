"""What the stream of a camera is called on both ends: its transport, its payload, and the name of one with a time."""

from __future__ import annotations

RTP_UDP = 1
"""VIDEO_STREAM_TYPE_RTPUDP."""
PAYLOAD_TYPE = 96
"""Of H.264 in RTP, as rpicam, GStreamer, ffmpeg and QGroundControl have it."""
COPY_PAYLOAD_TYPE = 97
"""Of the copy that our vehicle sends of each packet. Others drop it: with 96 ffmpeg does not recover from a loss."""
STAMPED = "camera, time in the top rows"
"""Name of a stream of our vehicle that carries link/services/video_stamp.py."""
MARKER = 0x80
"""Bit beside the payload type in a packet of RTP: it is the last one of a picture."""


def with_payload_type(packet: bytes, payload_type: int) -> bytes:
    """Return a packet of RTP with another payload type, and the same else."""
    return packet[:1] + bytes([packet[1] & MARKER | payload_type]) + packet[2:]
