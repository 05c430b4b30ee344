"""A router and a publisher of ROS 2 as processes. What they send is written here by hand, from rmw_zenoh's design.md.

python -m tests.e2e.ros2_peer router PORT
python -m tests.e2e.ros2_peer publish PORT X Z      a Twist at 20 Hz until it is killed
"""

from __future__ import annotations

import json
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import xxhash
import zenoh

TWIST = "geometry_msgs::msg::dds_::Twist_/RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"
STAMPED_HASH = "RIHS01_5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"
STAMPED = f"geometry_msgs::msg::dds_::TwistStamped_/{STAMPED_HASH}"
STRING = "std_msgs::msg::dds_::String_/RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
CDR = b"\x00\x01\x00\x00"
PERIOD = 0.05


def start(*words: object) -> subprocess.Popen[bytes]:
    """Start this module as a process; it prints a line when it is ready."""
    command = [sys.executable, "-m", "tests.e2e.ros2_peer", *map(str, words)]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stdout.readline(), "it did not start"
    return process


class Peer:
    """A node of another program: publishes, listens, calls."""

    def __init__(self, port: int, name: str = "teleop") -> None:
        self.session = open_session(port)
        self._name = name
        self.count = 0
        """Messages published so far."""
        self._held: dict[str, Any] = {}

    def twist(self, x: float, z: float = 0.0, up: float = 0.0) -> None:
        self.put("cmd_vel", TWIST, CDR + struct.pack("<6d", x, 0, up, 0, 0, z))

    def stamped(self, x: float) -> None:
        header = struct.pack("<iII4s", 0, 0, 1, b"")  # a stamp, the length of an empty text, its end and padding
        self.put("cmd_vel", STAMPED, CDR + header + struct.pack("<6d", x, 0, 0, 0, 0, 0))

    def word(self, text: str) -> None:
        data = text.encode() + b"\x00"
        self.put("command", STRING, CDR + struct.pack("<I", len(data)) + data)

    def put(self, topic: str, kind: str, data: bytes) -> None:
        """Publish; the first time the token is shown."""
        zid = self.session.info.zid()
        token = f"@ros2_lv/0/{zid}/0/7/MP/%/%/{self._name}/%{topic}/{kind}/::,1:,:,:,,"
        if token not in self._held:
            self._held[token] = self.session.liveliness().declare_token(token)
        self.count += 1
        gid = struct.pack("<Q", (number := xxhash.xxh3_128_intdigest(token.encode())) & (1 << 64) - 1)
        gid += struct.pack("<Q", number >> 64)
        attachment = struct.pack("<qqB", self.count, time.time_ns(), 16) + gid
        self.session.put(f"0/{topic}/{kind}", data, attachment=attachment)

    def listen(self, key: str, take: Callable[[bytes, bytes], None]) -> None:
        """Take payloads and attachments under a key."""

        def handle(sample: zenoh.Sample) -> None:
            take(bytes(sample.payload), bytes(sample.attachment or b""))

        self._held[key] = self.session.declare_subscriber(key, handle)

    def call(self, key: str, request: bytes) -> tuple[bytes, bytes]:
        """Call a service; return the response and its attachment."""
        attachment = struct.pack("<qqB16s", 3, time.time_ns(), 16, b"c" * 16)
        target = zenoh.QueryTarget.ALL_COMPLETE
        for reply in self.session.get(key, target=target, payload=CDR + request, attachment=attachment, timeout=60):
            assert reply.ok is not None, reply.err
            return bytes(reply.ok.payload), bytes(reply.ok.attachment or b"")
        raise AssertionError(f"no answer to {key}")

    def tokens(self) -> list[str]:
        """Return the liveliness tokens of domain 0."""
        found = self.session.liveliness().get("@ros2_lv/0/**", timeout=10)
        return [str(reply.ok.key_expr) for reply in found if reply.ok is not None]

    def close(self) -> None:
        self.session.close()  # type: ignore[no-untyped-call]


def open_session(port: int, mode: str = "client") -> zenoh.Session:
    config = zenoh.Config()
    where = "listen" if mode == "router" else "connect"
    config.insert_json5("mode", json.dumps(mode))
    config.insert_json5(f"{where}/endpoints", json.dumps([f"tcp/127.0.0.1:{port}"]))
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("transport/shared_memory/enabled", "false")
    return zenoh.open(config)


def main(what: str, port: str, *values: str) -> None:
    session = open_session(int(port), "router") if what == "router" else None
    peer = None if session else Peer(int(port), "other")
    print("ready", flush=True)
    while True:
        if peer is not None:
            peer.twist(*map(float, values))
        time.sleep(PERIOD)


if __name__ == "__main__":
    main(*sys.argv[1:])
