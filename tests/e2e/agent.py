"""An agent as the SDK's own client makes one: calls the tools named on its command line, and prints the answers."""

from __future__ import annotations

import asyncio
import json
import os
import sys

from mcp.client.session import ClientSession
from mcp.client.stdio import StdioServerParameters, stdio_client


async def _main(calls: list[str]) -> None:
    """Make the calls one after the other: each is TOOL followed by the JSON of its arguments."""
    server = StdioServerParameters(command=sys.executable, args=["-m", "groundstation", "mcp"], env=dict(os.environ))
    async with stdio_client(server) as streams, ClientSession(*streams) as session:
        await session.initialize()
        for tool, arguments in zip(calls[::2], calls[1::2], strict=True):
            answer = await session.call_tool(tool, json.loads(arguments))
            print(json.dumps({"tool": tool, "failed": answer.is_error, **answer.structured_content}), flush=True)


if __name__ == "__main__":
    asyncio.run(_main(sys.argv[1:]))
