"""`mavhelm mcp` with the SDK's own client and a station without a screen, and with clients that send anything."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from groundstation.station_socket.connect import running_stations
from tests.e2e.programs import Vehicle
from tests.e2e.test_agents import Agent
from tests.fakes.lines import on_line
from tests.fakes.multicopters import ArduCopter
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group("agents")]


def test_an_agent_reads_and_stops_without_a_screen(tmp_path: Path) -> None:
    port = free_port()
    vehicle = Vehicle(tmp_path, port)
    logs = tmp_path / "logs"
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", "--record-to", str(logs)]
    command.append(f"udpin:127.0.0.1:{port}")
    station = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        wait_until(lambda: running_stations() == [station.pid], "the station runs")
        agent = Agent(tmp_path, ("status", {}), ("arm", {"reason": "go"}), ("emergency_stop", {"reason": "smoke"}))
        assert agent.process.wait(PATIENCE) == 0, agent.said
        read, refused, stopped = agent.answers
        assert read["records"][0]["name"] == "Rover 1"
        assert "no screen of this station is open" in refused["error"]
        assert not stopped["failed"]
        wait_until(lambda: "EMERGENCY STOP" in vehicle.errors.read_text(), vehicle.errors.read_text)
        wait_until(
            lambda: any(b"agent reason: smoke" in each.read_bytes() for each in logs.rglob("*.tlog")), "recorded"
        )
    finally:
        station.terminate()
        station.wait()
        vehicle.end()


def test_a_copter_is_read_only_and_a_megabyte_is_refused(tmp_path: Path) -> None:
    with on_line(ArduCopter()) as copter:
        command = [sys.executable, "-m", "groundstation", "serve", "--headless", copter.endpoint]
        station = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            wait_until(lambda: running_stations() == [station.pid], "the station runs")
            huge = {"reason": "x" * 1_000_000}
            agent = Agent(tmp_path, ("status", {}), ("arm", huge), ("arm", {"reason": "go"}), ("status", {}))
            assert agent.process.wait(PATIENCE) == 0, agent.said
            read, megabyte, refused, again = agent.answers
            assert "flies: agents may only read it and stop it" in refused["error"]
            assert megabyte["error"] == "arguments of 1000014 characters: 16384 at most"
            assert read["records"][0]["name"] == again["records"][0]["name"]
            assert not copter.armed
        finally:
            station.terminate()
            station.wait()


RAW = {
    b"no json\n": "not a JSON-RPC message",
    b"[" * 100_000 + b"\n": "not a JSON-RPC message",
    b'{"jsonrpc": "2.0", "id": 1, "method": "x", "params": "' + b"x" * 5_000_000 + b'"}\n': "longer than 4194304 bytes",
    b"\xff\xfe\x00\n": "not a JSON-RPC message",
    b'{"jsonrpc": "2.0", "id": 5, "method": "fly"}\n': "Method not found",
}  # fmt: skip


def test_a_client_that_sends_no_messages_gets_errors(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", f"udpin:127.0.0.1:{free_port()}"]
    station = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    client = None
    try:
        wait_until(lambda: running_stations() == [station.pid], "the station runs")
        words = [sys.executable, "-m", "groundstation", "mcp"]
        client = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        assert client.stdin is not None
        assert client.stdout is not None
        info = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "x", "version": "1"}}
        start = {"jsonrpc": "2.0", "id": 0, "method": "initialize", "params": info}
        client.stdin.write(
            json.dumps(start).encode() + b"\n" + b'{"jsonrpc":"2.0","method":"notifications/initialized"}\n'
        )
        client.stdin.flush()
        assert json.loads(client.stdout.readline())["result"]["serverInfo"]["name"] == "mavhelm"
        for line, error in RAW.items():
            client.stdin.write(line)
            client.stdin.flush()
            assert error in json.loads(client.stdout.readline())["error"]["message"]
        out, errors = client.communicate(timeout=PATIENCE)
        assert (client.returncode, out) == (0, b"")
        assert [line.endswith(b": dropped") for line in errors.splitlines()] == [True] * (len(RAW) - 1), errors
    finally:
        if client is not None:
            client.kill()
            client.wait()
        station.terminate()
        station.wait()
