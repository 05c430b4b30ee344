"""Recipe: a command (MAV_CMD), in two files: its number, and its row with its handler."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

ROW = '            CommandSpec(Command.USER_1, self._toy, connected, "1: a number that is at least 1"),'

HANDLER = """    def _toy(self, request: CommandRequest, now: float) -> CommandResult:
        return Result.ACCEPTED if request.params[0] >= 1.0 else Result.DENIED
"""

SEND_IT = """
import socket, subprocess, sys
from dialects import codec
from dialects import messages as m

vehicle = subprocess.Popen(
    [sys.executable, "-m", "vehicle", "--sim", "udpin:127.0.0.1:{port}"], stdout=subprocess.PIPE, text=True,
    stderr=subprocess.STDOUT,
)

def frame(message, sequence):
    return codec.frame(message.id, codec.encode_payload(message), sequence, 255, 190)

def answer(station):
    while True:
        data = station.recv(65536)
        while data:
            size = data[1] + 12
            number = int.from_bytes(data[7:10], "little")
            if number == m.CommandAck.id:
                ack = codec.decode(number, data[10 : 10 + data[1]])
                if ack.command == 31010:
                    return ack.result
            data = data[size:]

try:
    assert vehicle.stdout is not None
    while "ready" not in vehicle.stdout.readline():
        assert vehicle.poll() is None
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.settimeout(20.0)
        station.connect(("127.0.0.1", {port}))
        station.send(frame(m.Heartbeat(6, 8, 0, 0, 4, 3), 0))
        station.send(frame(m.CommandLong(1, 1, 31010, 0, 2.0, 0, 0, 0, 0, 0, 0), 1))
        assert answer(station) == 0
        station.send(frame(m.CommandLong(1, 1, 31010, 0, 0.5, 0, 0, 0, 0, 0, 0), 2))
        assert answer(station) == 2
finally:
    vehicle.terminate()
    vehicle.communicate()
"""


def test_a_command(tree: Tree) -> None:
    tree.insert_before("dialects/enums.py", "    NAV_WAYPOINT = rover", "    USER_1 = rover.MAV_CMD_USER_1")
    requests = "vehicle/commands/requests.py"
    tree.insert_before(requests, "CommandSpec(Command.GET_HOME_POSITION", ROW)
    tree.insert_before(requests, "    def _get_home(self", HANDLER)
    tree.check_recipe("a command (MAV_CMD)")
    tree.run_script(SEND_IT.replace("{port}", str(tree.port)))
    assert "a number that is at least 1" in tree.run("vehicle", "dialect")
