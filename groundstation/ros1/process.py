"""The process of the node: started, read and written by this program, which never imports rospy.

What its topics bring is handed on with the time of its arrival. If this program is slow, what it has not read waits in
the pipe, and is too old then; what the node does not read of the telemetry is dropped.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

NODE = Path(__file__).with_name("node.py")
MAX_LINE = 1 << 16
"""Bytes of a line: the text of a String may be long."""
MAX_WAITING = 1 << 16
"""Bytes that wait for the node; more telemetry is dropped."""
END_WITHIN = 1.5
"""s for the node to sign off at the master."""


class NodeEndedError(Exception):
    """The process of the node has ended; the text says how, in one line."""


class NodeProcess:
    """A running node. `python` is an interpreter that has rospy."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        self._stdin, self._stdout = process.stdin, process.stdout
        self._errors = asyncio.ensure_future(_last_line(process.stderr))

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    async def read(self) -> dict[str, Any]:
        """Return its next line; {} for one, or a part of one, that is longer than MAX_LINE. Raises NodeEndedError."""
        try:
            line = await self._stdout.readline()
        except ValueError:
            return {}
        if not line:
            code = await self._process.wait()
            how = f"signal {-code}" if code < 0 else f"code {code}"
            said = await self._errors
            raise NodeEndedError(f"the node of ROS has ended ({how}){f': {said}' if said else ''}")
        try:
            fields = json.loads(line)
        except ValueError:  # the rest of a longer one
            return {}
        return fields if isinstance(fields, dict) else {}

    def publish(self, topic: str, kind: str, values: dict[str, Any]) -> None:
        """Publish a message, e.g. of "sensor_msgs/Imu", if the node reads."""
        if self._stdin.transport.get_write_buffer_size() < MAX_WAITING:
            row = {"topic": topic, "type": kind, "values": values}
            self._stdin.write(f"{json.dumps(row)}\n".encode())

    async def close(self) -> None:
        """End the process."""
        self._stdin.close()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._process.wait(), END_WITHIN)
        if self._process.returncode is None:
            self._process.kill()
            await self._process.wait()
        self._errors.cancel()


@asynccontextmanager
async def running_node(python: str, name: str, topics: dict[str, str]) -> AsyncIterator[NodeProcess]:
    """Start a node with this name that subscribes topics, of these types; it ends with the block. Raises OSError."""
    words = [f"{topic}={kind}" for topic, kind in topics.items()]
    pipe = asyncio.subprocess.PIPE
    node = NodeProcess(
        await asyncio.create_subprocess_exec(
            python, str(NODE), name, *words, stdin=pipe, stdout=pipe, stderr=pipe, limit=MAX_LINE
        )
    )
    try:
        yield node
    finally:
        await asyncio.shield(node.close())


async def _last_line(stream: asyncio.StreamReader) -> str:
    """Read all, which keeps the process from waiting; return the last line."""
    last = b""
    while chunk := await stream.read(MAX_LINE):
        last = (last + chunk)[-MAX_LINE:]
    return (last.decode(errors="replace").strip().splitlines() or [""])[-1]
