"""The process of the node: how it ends, and that it cannot hold this program up."""

from __future__ import annotations

import asyncio
import os
import signal
from pathlib import Path

import pytest

from groundstation.ros1.process import MAX_WAITING, NodeEndedError, running_node
from tests.waits import PATIENCE

TOPICS = {"command": "std_msgs/String"}


def program(folder: Path, text: str) -> str:
    """Write a program that stands in for the interpreter."""
    path = folder / "python"
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)
    return str(path)


async def test_its_end_is_told_with_its_last_words(tmp_path: Path) -> None:
    python = program(tmp_path, "echo one >&2; echo out of luck >&2; exit 3")
    async with running_node(python, "name", TOPICS) as node:
        with pytest.raises(NodeEndedError, match=r"^the node of ROS has ended \(code 3\): out of luck$"):
            await node.read()


async def test_a_kill_is_told(tmp_path: Path) -> None:
    async with running_node(program(tmp_path, "exec sleep 1000"), "name", TOPICS) as node:
        os.kill(node.pid, signal.SIGKILL)
        with pytest.raises(NodeEndedError, match=r"^the node of ROS has ended \(signal 9\)$"):
            await node.read()


async def test_it_gets_its_name_and_topics_and_a_long_line_is_skipped(tmp_path: Path) -> None:
    python = program(
        tmp_path, """head -c 200000 /dev/zero | tr '\\0' x; echo; echo "{\\"words\\": \\"$2 $3\\"}"; cat"""
    )
    async with running_node(python, "name", TOPICS) as node:
        while not (line := await asyncio.wait_for(node.read(), PATIENCE)):
            pass
        assert line == {"words": "name command=std_msgs/String"}


async def test_a_node_that_does_not_read_costs_no_memory_and_is_killed(tmp_path: Path) -> None:
    async with running_node(program(tmp_path, "exec sleep 1000"), "name", TOPICS) as node:
        for _ in range(3000):
            node.publish("imu", "sensor_msgs/Imu", {"text": "x" * 100})
        assert node._stdin.transport.get_write_buffer_size() < 2 * MAX_WAITING
    with pytest.raises(ProcessLookupError):
        os.kill(node.pid, 0)


async def test_no_such_interpreter() -> None:
    with pytest.raises(FileNotFoundError):
        async with running_node("/nowhere/python", "name", TOPICS):
            pass
