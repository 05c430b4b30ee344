"""`mavhelm mcp`: the station's side of an agent, and what runs in the process that the agent's program has started."""

from __future__ import annotations

import argparse
from typing import Any

from groundstation.verbs.agents.agent_calls import AgentCalls
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.session import VerbSession
from link.runtime.install_hint import install_command


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Run the calls of the agent; done when its input ends and what ran was stopped. Raises VerbError."""
    await AgentCalls(session).run()
    return ExitCode.DONE


def prepare(options: argparse.Namespace) -> Any:
    """Check that the packages of the extra are there. Raises VerbError."""
    try:
        import mcp.server.lowlevel  # noqa: F401
    except ModuleNotFoundError as error:
        text = f"MCP needs the package {error.name}, which is not installed: {install_command('agents')}"
        raise VerbError(ExitCode.USAGE, text) from None


async def serve(options: argparse.Namespace, output: Output, verb: CompanionChannel) -> None:
    """Serve MCP on stdin and stdout, as the companion. Raises VerbError."""
    from groundstation.verbs.agents.server import serve_agent

    await serve_agent(verb)
