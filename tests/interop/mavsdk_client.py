"""A user's script for MAVSDK: `python mavsdk_client.py PORT SCENARIO FOLDER`. Prints JSON, a line a step.

A process of its own: MAVSDK is a C++ library with threads, and what crashes there must not take pytest along. What
MAVSDK itself has to say goes to stderr.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Callable
from enum import Enum
from functools import partial
from importlib import import_module
from typing import Any

from mavsdk import ComponentType, Configuration, Mavsdk

PATIENCE = 10.0
"""s for an answer that MAVSDK brings by a callback."""


def plugin(name: str, system: Any) -> Any:
    """The plugin's object; MAVSDK has a module of the same name for each."""
    module = import_module(f"mavsdk.plugins.{name}.{name}")
    return getattr(module, "".join(part.capitalize() for part in name.split("_")))(system)


def step(name: str, run: Callable[[], Any]) -> Any:
    """Run a step; print what came of it and how long it took."""
    start = time.monotonic()
    try:
        value, error = run(), None
    except Exception as exception:
        value, error = None, f"{type(exception).__name__}: {exception}"
    print(
        json.dumps({"step": name, "value": shown(value), "error": error, "took": time.monotonic() - start}), flush=True
    )
    return value


def shown(value: Any) -> Any:
    """As JSON has it."""
    if isinstance(value, Enum):
        return value.name
    return value if isinstance(value, int | float | str | list | None) else str(value)


def first(subscribe: Callable[[Callable[..., None]], Any], good: Callable[[Any], bool]) -> Any:
    """The first value of a stream that is `good`."""
    came, found = threading.Event(), []

    def take(value: Any, *_: Any) -> None:
        if good(value) and not came.is_set():
            found.append(value)
            came.set()

    subscribe(take)
    if not came.wait(PATIENCE):
        raise TimeoutError("nothing came")
    return found[0]


def finished(start: Callable[[Callable[..., None]], Any]) -> str:
    """The final result of a transfer that reports its progress."""
    done, results = threading.Event(), []

    def take(result: Any, *_: Any) -> None:
        if result.name != "NEXT":
            results.append(result.name)
            done.set()

    start(take)
    if not done.wait(PATIENCE):
        raise TimeoutError("it did not end")
    return str(results[0])


def wait_for_line(end: threading.Event) -> None:
    """Set `end` when a line comes on stdin."""
    sys.stdin.readline()
    end.set()


def identity(system: Any, folder: str) -> None:
    """Who is it, and what does it tell?"""
    info, telemetry = plugin("info", system), plugin("telemetry", system)
    step("version", lambda: info.get_version().flight_sw_major)
    streams = {
        "position": lambda value: abs(value.latitude_deg) > 1,
        "home": lambda value: abs(value.latitude_deg) > 1,
        "attitude_euler": lambda value: True,
        "velocity_ned": lambda value: True,
        "gps_info": lambda value: value.num_satellites > 5,
        "battery": lambda value: value.voltage_v > 5,
        "heading": lambda value: True,
        "landed_state": lambda value: True,
        "health": lambda value: value.is_home_position_ok and value.is_global_position_ok,
    }
    for name, good in streams.items():
        step(name, partial(first, getattr(telemetry, f"subscribe_{name}"), good))


def parameters(system: Any, folder: str) -> None:
    """Read, set, and be refused."""
    param = plugin("param", system)
    step("all", lambda: len(param.get_all_params().float_params))
    step("get", lambda: param.get_param_float("SPEED_MAX"))
    step("set", lambda: param.set_param_float("SPEED_MAX", 1.4))
    step("get again", lambda: param.get_param_float("SPEED_MAX"))
    step("unknown", lambda: param.get_param_float("NO_SUCH"))
    step("set unknown", lambda: param.set_param_float("NO_SUCH", 1.0))
    step("out of range", lambda: param.set_param_float("SPEED_MAX", 5000.0))


def driving(system: Any, folder: str) -> None:
    """Arm, drive by hand until a line comes on stdin, hold, disarm."""
    action, manual, telemetry = (plugin(name, system) for name in ("action", "manual_control", "telemetry"))
    first(telemetry.subscribe_health, lambda value: value.is_global_position_ok)
    step("arm", action.arm)
    end = threading.Event()
    threading.Thread(target=wait_for_line, args=(end,), daemon=True).start()
    begun = time.monotonic()
    while not end.wait(0.05):  # neutral first, then ahead
        manual.set_manual_control_input(0.0 if time.monotonic() - begun < 0.3 else 0.5, 0.0, 0.0, 0.0)
    step("hold", action.hold)
    step("disarm", action.disarm)


def guided(system: Any, folder: str) -> None:
    """Go somewhere, come back, and drive by velocity; each until a line comes on stdin."""
    action, offboard, telemetry = (plugin(name, system) for name in ("action", "offboard", "telemetry"))
    velocity = import_module("mavsdk.plugins.offboard.offboard").VelocityBodyYawspeed
    here = first(telemetry.subscribe_position, lambda value: abs(value.latitude_deg) > 1)
    first(telemetry.subscribe_health, lambda value: value.is_global_position_ok)
    step("arm", action.arm)
    step("goto", lambda: action.goto_location(here.latitude_deg + 0.0001, here.longitude_deg, 0.0, 0.0))
    sys.stdin.readline()
    step("return", action.return_to_launch)
    sys.stdin.readline()
    step("hold", action.hold)
    step("setpoint", lambda: offboard.set_velocity_body(velocity(0.5, 0.0, 0.0, 0.0)))
    step("offboard", offboard.start)
    sys.stdin.readline()
    step("stop", offboard.stop)
    step("disarm", action.disarm)


def mission(system: Any, folder: str) -> None:
    """Upload, download, be refused, drive it to its end, clear."""
    action, raw, telemetry = (plugin(name, system) for name in ("action", "mission_raw", "telemetry"))
    make = import_module("mavsdk.plugins.mission_raw.mission_raw").MissionItem
    first(telemetry.subscribe_health, lambda value: value.is_global_position_ok)
    here = first(telemetry.subscribe_position, lambda value: abs(value.latitude_deg) > 1)
    north, east = round(here.latitude_deg * 1e7), round(here.longitude_deg * 1e7)
    plan = [make(n, 3, 16, n == 0, 1, 0, 0, 0, float("nan"), north + 300 * n, east, 0, 0) for n in range(2)]
    step("upload", lambda: raw.upload_mission(plan))
    step("download", lambda: [[each.seq, each.command, each.x, each.y] for each in raw.download_mission()] == [
        [each.seq, each.command, each.x, each.y] for each in plan])  # fmt: skip
    step("refused", lambda: raw.upload_mission([make(0, 3, 22, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0)]))
    step(
        "fence",
        lambda: raw.upload_geofence(
            [
                make(n, 3, 5001, 0, 1, 3, 0, 0, 0, north + (n == 1) * 90000, east + (n == 2) * 90000, 0, 1)
                for n in range(3)
            ]
        ),
    )
    step("fence back", lambda: len(raw.download_geofence()))
    step("arm", action.arm)
    step("start", raw.start_mission)
    step("progress", lambda: first(raw.subscribe_mission_progress, lambda value: value.current >= 1))
    step("finished", lambda: wait_until(lambda: raw.is_mission_finished()))
    step("disarm", action.disarm)
    step("clear", raw.clear_mission)
    step("empty", lambda: len(raw.download_mission()))


def wait_until(condition: Callable[[], bool]) -> bool:
    """Look until it is so."""
    deadline, pause = time.monotonic() + 2 * PATIENCE, threading.Event()
    while not condition() and time.monotonic() < deadline:
        pause.wait(0.1)
    return condition()


def files(system: Any, folder: str) -> None:
    """Files, logs, and what the parameters mean."""
    ftp, logs, metadata = (plugin(name, system) for name in ("ftp", "log_files", "component_metadata"))
    step("root", lambda: [entry.name for entry in ftp.list_directory("/").entries])
    for burst in (True, False):
        path = "/parameter.json.xz" if burst else "@PARAM/param.pck"
        step(path, partial(finished, partial(ftp.download_async, path, folder, burst)))
    step("same", lambda: ftp.are_files_identical(f"{folder}/parameter.json.xz", "/parameter.json.xz"))
    step("no file", lambda: finished(lambda take: ftp.download_async("/none", folder, True, take)))
    step("write", lambda: ftp.create_directory("/mine"))
    step("logs", lambda: len(logs.get_entries()))
    kinds = import_module("mavsdk.plugins.component_metadata.component_metadata").MetadataType
    available = threading.Event()
    metadata.subscribe_metadata_available(lambda *_: available.set())
    metadata.request_autopilot_component()
    step("metadata", lambda: available.wait(PATIENCE))
    step("meaning", lambda: metadata.get_metadata(1, kinds.PARAMETER).json_metadata)


def recordings(system: Any, folder: str) -> None:
    """The list of logs, and each of them."""
    logs = plugin("log_files", system)
    entries = logs.get_entries()
    step("logs", lambda: [[entry.id, entry.date, entry.size_bytes] for entry in entries])
    for entry in entries:
        path = f"{folder}/fetched-{entry.id}"
        step(f"log {entry.id}", partial(finished, partial(logs.download_log_file_async, entry, path)))


SCENARIOS = {each.__name__: each for each in (identity, parameters, driving, guided, mission, files, recordings)}


def main(port: str, scenario: str, folder: str) -> None:
    """Connect and run one scenario."""
    sdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    step("connect", lambda: str(sdk.add_any_connection(f"udpin://127.0.0.1:{port}")))
    system = step("discover", lambda: sdk.first_autopilot(10.0))
    SCENARIOS[scenario](system, folder)
    os._exit(0)  # its threads end when they please


if __name__ == "__main__":
    main(*sys.argv[1:])
