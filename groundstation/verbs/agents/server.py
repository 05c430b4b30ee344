"""The MCP server of `mavhelm mcp`: lists the tools, passes calls on to the station, and asks whether the client lives.

It speaks the versions of the protocol with a handshake. In the later ones a server cannot ask its client whether it
still runs, and a client that stands still could not be told from one that waits.
"""

from __future__ import annotations

import asyncio
import json
from importlib.metadata import version
from itertools import count
from typing import Any

import mcp_types as types
from mcp.server.context import ServerRequestContext
from mcp.server.lowlevel import Server
from mcp.server.runner import serve_loop
from mcp.shared.exceptions import MCPError

from groundstation.verbs.agents.client_pipe import open_client
from groundstation.verbs.agents.tools import TOOLS, Tool, ToolEffect
from groundstation.verbs.common.channel import CompanionChannel

PING_PERIOD = 0.08
"""s between two questions whether the client still runs, while a proposal of it waits or runs."""
PING_WITHIN = 1.0
"""s for an answer, before the next question."""

MOST_ARGUMENTS = 16 << 10
"""Characters of JSON that the arguments of one call may have; the station checks each of them."""

INSTRUCTIONS = """\
Tools of a ground station with a rover. Reading tools and stops run at once. Whatever moves, arms or changes settings
is a proposal: it waits on the operator's screen and runs only while a person holds a key there. The call returns when
it is done, declined, stopped or nobody has held the key. Give a short honest reason, and propose one step at a time."""

_EFFECTS = {
    ToolEffect.READ: "",
    ToolEffect.STOP: "",
    ToolEffect.PROPOSE: " A proposal: it runs only while the operator holds a key.",
}

Context = ServerRequestContext[Any, Any]


class AgentServer:
    """The server of one client. `verb` leads to the verb in the station."""

    def __init__(self, verb: CompanionChannel) -> None:
        self._verb = verb
        self._numbers = count(1)
        self._waiting: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self._named = False

    async def receive(self) -> None:
        """Handle what the verb sends, until it ends. Raises VerbError, ChannelEndedError."""
        while True:
            value = await self._verb.receive()
            waiting = self._waiting.get(value["id"])
            if waiting is not None and not waiting.done():
                waiting.set_result(value)

    async def list_tools(self, context: Context, params: types.PaginatedRequestParams | None) -> types.ListToolsResult:
        """Return all tools."""
        return types.ListToolsResult(tools=[_describe(name, tool) for name, tool in TOOLS.items()])

    async def call_tool(self, context: Context, params: types.CallToolRequestParams) -> types.CallToolResult:
        """Have the station run a tool; return how it has ended."""
        self._introduce(context)
        size = len(json.dumps(params.arguments))
        if size > MOST_ARGUMENTS:
            return _answer({"fields": {}, "error": f"arguments of {size} characters: {MOST_ARGUMENTS} at most"})
        tool = TOOLS.get(params.name)
        number, ended = next(self._numbers), asyncio.get_running_loop().create_future()
        self._waiting[number] = ended
        self._verb.send({"type": "call", "id": number, "tool": params.name, "arguments": params.arguments or {}})
        pings = None
        if tool is not None and tool.effect is ToolEffect.PROPOSE:
            pings = asyncio.ensure_future(self._ask_client(context))
        try:
            return _answer(await ended)
        except asyncio.CancelledError:
            self._verb.send({"type": "cancel", "id": number})
            raise
        finally:
            del self._waiting[number]
            if pings is not None:
                pings.cancel()

    def _introduce(self, context: Context) -> None:
        """Tell the station what the client calls itself."""
        client = context.session.client_params
        if not self._named and client is not None:
            self._named = True
            self._verb.send({"type": "named", "name": client.client_info.name})

    async def _ask_client(self, context: Context) -> None:
        """Ask the client again and again whether it runs, and pass on each answer; one that refuses has answered."""
        while True:
            try:
                await context.session.send_request(types.PingRequest(), types.EmptyResult, PING_WITHIN)
            except MCPError as error:
                if error.error.code == types.REQUEST_TIMEOUT:
                    continue
            self._verb.send({"type": "alive"})
            await asyncio.sleep(PING_PERIOD)


async def serve_agent(verb: CompanionChannel) -> None:
    """Serve the client on stdin and stdout until one of both ends. Raises VerbError."""
    agent = AgentServer(verb)
    server: Server[Any] = Server(
        "mavhelm",
        version=version("mavhelm"),
        instructions=INSTRUCTIONS,
        on_list_tools=agent.list_tools,
        on_call_tool=agent.call_tool,
    )
    async with open_client() as (incoming, outgoing):
        serving = asyncio.ensure_future(serve_loop(server, incoming, outgoing, lifespan_state={}))
        receiving = asyncio.ensure_future(agent.receive())
        try:
            ended, _ = await asyncio.wait({serving, receiving}, return_when=asyncio.FIRST_COMPLETED)
            for each in ended:
                each.result()
        finally:
            serving.cancel()
            receiving.cancel()
            await asyncio.wait({serving, receiving})


def _describe(name: str, tool: Tool) -> types.Tool:
    reads = tool.effect is ToolEffect.READ
    hints = types.ToolAnnotations(read_only_hint=reads, destructive_hint=tool.effect is ToolEffect.PROPOSE)
    text = tool.help + _EFFECTS[tool.effect]
    return types.Tool(name=name, description=text, input_schema=tool.schema, annotations=hints)


def _answer(ended: dict[str, Any]) -> types.CallToolResult:
    fields = {**ended["fields"], "error": ended["error"]} if ended["error"] else ended["fields"]
    text = types.TextContent(type="text", text=json.dumps(fields, ensure_ascii=False))
    return types.CallToolResult(content=[text], structured_content=fields, is_error=bool(ended["error"]))
