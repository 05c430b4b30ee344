"""A vehicle made of MAVSDK's server plugins: `python -m tests.interop.mavsdk_vehicle ENDPOINT FOLDER COUNT`.

It has COUNT whole parameters and one other, plans, files and modes, and arms. It prints JSON, one line for each thing
that a ground station did to it, and runs until its input ends. A process of its own, because MAVSDK is a C++ library
with threads.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.action_server.action_server import AllowableFlightModes

from tests.interop.mavsdk_tools import plugin


def main(endpoint: str, folder: str, count: int) -> None:
    """Serve until the input ends."""
    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.AUTOPILOT))
    server = mavsdk.server_component()
    (Path(folder) / "hello.txt").write_text("from a vehicle of MAVSDK\n")
    kept = [_params(server, count), _plans(server), _actions(server), _files(server, folder)]
    mavsdk.add_any_connection(endpoint)
    _say("ready", len(kept))
    sys.stdin.read()


def _say(what: str, value: object) -> None:
    sys.stdout.write(json.dumps({"what": what, "value": value}) + "\n")
    sys.stdout.flush()


def _params(server: Any, count: int) -> Any:
    params = plugin("param_server", server)
    params.provide_param_float("SPEED_MAX", 1.5)
    for number in range(count):
        params.provide_param_int(f"TEST_{number:03}", number)
    params.subscribe_changed_param_float(lambda param, *_: _say("float", [param.name, param.value]))
    params.subscribe_changed_param_int(lambda param, *_: _say("int", [param.name, param.value]))
    return params


def _plans(server: Any) -> Any:
    missions = plugin("mission_raw_server", server)
    missions.subscribe_incoming_mission(
        lambda _, plan, *__: _say("mission", [[item.command, item.x, item.y] for item in plan.mission_items])
    )
    missions.subscribe_clear_all(lambda *_: _say("clear", None))
    return missions


def _actions(server: Any) -> Any:
    actions = plugin("action_server", server)
    actions.set_armable(True, False)
    actions.set_disarmable(True, False)
    actions.set_allowable_flight_modes(
        AllowableFlightModes(can_auto_mode=True, can_guided_mode=True, can_stabilize_mode=True)
    )
    actions.subscribe_arm_disarm(lambda _, change, *__: _say("arm", change.arm))
    return actions


def _files(server: Any, folder: str) -> Any:
    files = plugin("ftp_server", server)
    files.set_root_dir(folder)
    return files


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
