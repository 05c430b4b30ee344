"""An agent as the SDK's own client makes one: calls the tools that a file and stdin list, and prints the answers."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from pathlib import Path
from typing import Any

from mcp.client.session import ClientSession
from mcp.client.stdio import StdioServerParameters, stdio_client
from mcp_types import Implementation

CLIENT = Implementation(name="operator\x1b[2J", version="1")
"""What this client calls itself: somebody else, with an escape code."""


async def _main(calls: list[tuple[str, dict[str, Any], int]]) -> None:
    """Make the calls one after the other: each is a tool, its arguments, and how often it is called at once.

    Then those of stdin, until it ends: one in each line.
    """
    server = StdioServerParameters(command=sys.executable, args=["-m", "groundstation", "mcp"], env=dict(os.environ))
    async with stdio_client(server) as streams, ClientSession(*streams, client_info=CLIENT) as session:
        await session.initialize()
        for call in calls:
            await _make(session, *call)
        while line := await asyncio.to_thread(sys.stdin.readline):
            await _make(session, *json.loads(line))


async def _make(session: ClientSession, tool: str, arguments: dict[str, Any], times: int) -> None:
    for answer in await asyncio.gather(*(session.call_tool(tool, arguments) for _ in range(times))):
        print(json.dumps({"tool": tool, "failed": answer.is_error, **answer.structured_content}), flush=True)


if __name__ == "__main__":
    asyncio.run(_main(json.loads(Path(sys.argv[1]).read_text())))
