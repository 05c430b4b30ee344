"""Forward MAVLink between two links and print their rates: `python bridge_two_links.py ENDPOINT ENDPOINT`."""

from __future__ import annotations

import asyncio
import signal
import sys

from link.bridge.bridge import Bridge
from link.bridge.status import BridgeStatus
from link.transport.transports import open_transports


def show(status: BridgeStatus) -> None:
    """Print one line a second."""
    print(
        " | ".join(f"{link.endpoint}: {link.frames_in_per_s:.0f} frames/s received" for link in status.links),
        flush=True,
    )


async def serve(endpoints: list[str]) -> None:
    """Forward until Ctrl-C."""
    bridge = Bridge(open_transports(endpoints), show)
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, bridge.stop)
    await bridge.run()


if __name__ == "__main__":
    asyncio.run(serve(sys.argv[1:]))
