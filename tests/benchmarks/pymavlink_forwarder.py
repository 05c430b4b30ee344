"""The simplest router: pymavlink on both ends, whatever arrives is written to the other. Arguments: IN OUT."""

from __future__ import annotations

import sys

from pymavlink import mavutil


def main(source: str, target: str) -> None:
    """Forward until killed."""
    arrives = mavutil.mavlink_connection(source)  # type: ignore[no-untyped-call]
    leaves = mavutil.mavlink_connection(target)  # type: ignore[no-untyped-call]
    print("ready", flush=True)
    while True:
        message = arrives.recv_match(blocking=True)
        leaves.write(message.get_msgbuf())


if __name__ == "__main__":
    main(*sys.argv[1:3])
