"""A user's script for MAVSDK: `python -m tests.interop.mavsdk_client PORT|URL SCENARIO FOLDER SYSTEM`.

It prints JSON, one line per step. It is a process of its own, because MAVSDK is a C++ library with threads, whose crash
must not end pytest. MAVSDK's own output goes to stderr.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from mavsdk import ComponentType, Configuration, Mavsdk

from tests.interop import mavsdk_streams
from tests.interop.mavsdk_tools import (
    Stick,
    accepted,
    by_hand,
    fetched,
    finished,
    first,
    following,
    insist,
    plugin,
    refused,
    step,
    twenty,
    unless_busy,
    wait_until,
    watch,
)
from tests.waits import PATIENCE


def identity(system: Any, folder: str) -> None:
    """Identify the vehicle and read its telemetry."""
    info, telemetry = plugin("info", system), plugin("telemetry", system)
    step("version", lambda: info.get_version().flight_sw_major)
    for name in mavsdk_streams.ASKED:
        step(f"rate of {name}", partial(getattr(telemetry, f"set_rate_{name}"), 10.0))
    waits = {
        name: following(getattr(telemetry, f"subscribe_{name}"), good)
        for name, good in {**mavsdk_streams.UNASKED, **mavsdk_streams.ASKED}.items()
    }
    for name, wait in waits.items():
        step(name, wait)
    step("faster", lambda: telemetry.set_rate_attitude_euler(20.0))
    step("20 at 20 Hz", lambda: twenty(telemetry.subscribe_attitude_euler))


def parameters(system: Any, folder: str) -> None:
    """Read and set parameters, and be refused."""
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
    step("arm", lambda: insist(action.arm))
    by_hand(manual, 0.5)
    step("hold", action.hold)
    step("disarm", action.disarm)


def outsider(system: Any, folder: str) -> None:
    """Watch a vehicle that obeys signed commands only, and try to arm it until it says why not."""
    action, telemetry = plugin("action", system), plugin("telemetry", system)
    reason = following(telemetry.subscribe_status_text, lambda text: "not signed" in text.text)
    step("place", lambda: first(telemetry.subscribe_position, lambda place: True).latitude_deg)
    step("denied", lambda: refused(action.arm, "DENIED"))
    step("reason", lambda: reason().text)


def leaving(system: Any, folder: str) -> None:
    """Restart and shut down the vehicle, each with a line on stdin, in a run of its own."""
    action = plugin("action", system)
    for line in sys.stdin:
        step(line.strip(), partial(insist, getattr(action, line.strip())))


def places(system: Any, folder: str) -> None:
    """Set home and the origin of local positions, and read them back."""
    action, telemetry = plugin("action", system), plugin("telemetry", system)
    north, east = here(telemetry)
    step("home", lambda: insist(lambda: action.set_home(False, (north + AWAY) / 1e7, east / 1e7, 0.0)))
    near = 1e-7
    step("home told", lambda: first(
        telemetry.subscribe_home, lambda home: abs(home.latitude_deg - (north + AWAY) / 1e7) < near
    ).latitude_deg)  # fmt: skip
    step("origin", lambda: action.set_gps_global_origin((north - AWAY) / 1e7, east / 1e7, 500.0))
    step("origin told", lambda: telemetry.get_gps_global_origin().altitude_m)


def guided(system: Any, folder: str) -> None:
    """Go to a place at a speed, return, drive by velocity; each until a line comes on stdin."""
    action, offboard, telemetry = (plugin(name, system) for name in ("action", "offboard", "telemetry"))
    velocity = import_module("mavsdk.plugins.offboard.offboard").VelocityBodyYawspeed
    north, east = here(telemetry)
    fastest: list[float] = []
    telemetry.subscribe_fixedwing_metrics(lambda metrics, *_: fastest.append(metrics.groundspeed_m_s))
    step("arm", lambda: insist(action.arm))
    step("speed", lambda: action.set_current_speed(0.5))
    step("goto", lambda: action.goto_location((north + AWAY) / 1e7, east / 1e7, 0.0, 0.0))
    sys.stdin.readline()
    step("gone", lambda: first(telemetry.subscribe_position, lambda place: True).latitude_deg * 1e7 - north)
    step("fastest", lambda: max(fastest))
    step("usual speed", lambda: action.set_current_speed(0.8))
    step("return", action.return_to_launch)
    sys.stdin.readline()
    step("hold", action.hold)
    sys.stdin.readline()
    step("setpoint", lambda: offboard.set_velocity_body(velocity(0.5, 0.0, 0.0, 0.0)))
    step("offboard", offboard.start)
    sys.stdin.readline()
    step("stop", offboard.stop)
    step("disarm", action.disarm)


AWAY = 110
"""Degrees x 1e7 to the north: 1.2 m."""


def here(telemetry: Any) -> tuple[int, int]:
    """Return the position of the rover in degrees x 1e7, once it is known."""
    first(telemetry.subscribe_health, lambda value: value.is_global_position_ok)
    place = first(telemetry.subscribe_position, lambda value: abs(value.latitude_deg) > 1)
    return round(place.latitude_deg * 1e7), round(place.longitude_deg * 1e7)


def item(number: int, command: int, first: float, north: int, east: int, kind: int = 0) -> Any:
    """Return an item of a plan."""
    make = import_module("mavsdk.plugins.mission_raw.mission_raw").MissionItem
    return make(number, 3, command, number == 0, 1, first, 0, 0, float("nan"), north, east, 0, kind)


def shape(plan: list[Any]) -> list[list[int]]:
    """Return the fields that must be the same after a download."""
    return [[each.seq, each.command, each.x, each.y] for each in plan]


def mission(system: Any, folder: str) -> None:
    """Upload, download, be refused, drive to the end, clear."""
    action, raw, telemetry = (plugin(name, system) for name in ("action", "mission_raw", "telemetry"))
    north, east = here(telemetry)
    plan = [item(n, 16, 0, north + 200 * (n + 1), east) for n in range(2)]
    step("upload", lambda: unless_busy(lambda: raw.upload_mission(plan)))
    step("download", lambda: shape(unless_busy(raw.download_mission)) == shape(plan))
    step("refused", lambda: unless_busy(lambda: raw.upload_mission([item(0, 22, 0, north, east)])))
    fence = [item(n, 5001, 3, north + (n == 1) * 90000, east + (n == 2) * 90000, kind=1) for n in range(3)]
    step("fence", lambda: unless_busy(lambda: raw.upload_geofence(fence)))
    step("fence back", lambda: len(unless_busy(raw.download_geofence)))
    step("arm", lambda: insist(action.arm))
    step("start", raw.start_mission)
    step("progress", lambda: first(raw.subscribe_mission_progress, lambda value: value.current >= 1))
    step("finished", lambda: wait_until(lambda: raw.is_mission_finished()))
    step("disarm", action.disarm)
    step("clear", lambda: unless_busy(raw.clear_mission))
    step("empty", lambda: len(unless_busy(raw.download_mission)))


def plan(system: Any, folder: str) -> None:
    """Drive a mission as in MAVSDK's examples, with a speed for each item; one has items that a rover cannot do."""
    action, missions, telemetry = (plugin(name, system) for name in ("action", "mission", "telemetry"))
    kinds = import_module("mavsdk.plugins.mission.mission")
    north, east = here(telemetry)
    camera, nothing = kinds.MissionItem.CameraAction, float("nan")

    def place(number: int, action: Any) -> Any:
        where = ((north + 200 * number) / 1e7, east / 1e7, 0.0)
        none = kinds.MissionItem.VehicleAction.NONE
        return kinds.MissionItem(*where, 0.8, True, nothing, nothing, action, *[nothing] * 5, none)

    photo = kinds.MissionPlan([place(1, camera.TAKE_PHOTO)])
    step("refused", lambda: insist(lambda: refused(partial(missions.upload_mission, photo), "UNSUPPORTED")))
    there = kinds.MissionPlan([place(1, camera.NONE), place(2, camera.NONE)])
    step("upload", lambda: unless_busy(lambda: missions.upload_mission(there)))
    step("download", lambda: len(unless_busy(missions.download_mission).mission_items))
    step("arm", lambda: insist(action.arm))
    step("start", missions.start_mission)
    step("progress", lambda: first(missions.subscribe_mission_progress, lambda value: value.current == value.total))
    step("finished", lambda: wait_until(lambda: missions.is_mission_finished()))


def files(system: Any, folder: str) -> None:
    """Download files, logs, and the parameter metadata."""
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
    """List the logs and download each."""
    logs = plugin("log_files", system)
    entries = logs.get_entries()
    step("logs", lambda: [[entry.id, entry.date, entry.size_bytes] for entry in entries])
    for entry in entries:
        path = f"{folder}/fetched-{entry.id}"
        step(f"log {entry.id}", partial(finished, partial(logs.download_log_file_async, entry, path)))


def lossy(system: Any, folder: str) -> None:
    """Do everything over a lossy link, with retries."""
    action, ftp, manual, param, raw, telemetry = (
        plugin(name, system) for name in ("action", "ftp", "manual_control", "param", "mission_raw", "telemetry")
    )
    step("parameters", lambda: len(insist(param.get_all_params).float_params))
    step("set", lambda: insist(lambda: param.set_param_float("SPEED_MAX", 1.4)))
    step("get", lambda: insist(lambda: param.get_param_float("SPEED_MAX")))
    path = "/missions/mission.waypoints"
    step("file", lambda: insist(lambda: fetched(lambda take: ftp.download_async(path, folder, True, take))))
    north, east = here(telemetry)
    plan = [item(n, 16, 0, north + 150 * (n + 1), east) for n in range(2)]
    step("upload", lambda: insist(lambda: raw.upload_mission(plan)))
    step("download", lambda: shape(insist(raw.download_mission)) == shape(plan))
    step("arm", lambda: insist(action.arm))
    by_hand(manual, 0.5)
    sys.stdin.readline()
    step("start", lambda: insist(raw.start_mission))
    step("finished", lambda: wait_until(lambda: raw.is_mission_finished()))
    step("disarm", lambda: insist(action.disarm))


def wheel(system: Any, folder: str) -> None:
    """Follow the lines on stdin, and print what is seen; `push` is repeated until the next line."""
    action, direct, manual, telemetry = (
        plugin(name, system) for name in ("action", "mavlink_direct", "manual_control", "telemetry")
    )
    watch(telemetry)
    stick = Stick(manual)
    verbs: dict[str, Callable[..., Any]] = {
        "arm": lambda: insist(action.arm),
        "disarm": action.disarm,
        "push": lambda throttle: stick.hold(float(throttle)),
        "command": lambda *words: accepted(direct, *map(float, words)),
    }
    for line in sys.stdin:
        verb, *words = line.split()
        step(line.strip(), lambda verb=verb, words=words: verbs[verb](*words))  # type: ignore[misc]


SCENARIOS = {
    each.__name__: each
    for each in (
        identity,
        parameters,
        driving,
        outsider,
        leaving,
        places,
        guided,
        mission,
        plan,
        files,
        recordings,
        lossy,
        wheel,
    )
}


def main(port: str, scenario: str, folder: str, system_id: str) -> None:
    """Connect and run one scenario."""
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    configuration.system_id = int(system_id)
    sdk = Mavsdk(configuration)
    url = port if "://" in port else f"udpin://127.0.0.1:{port}"
    step("connect", lambda: str(sdk.add_any_connection(url)))
    system = step("discover", lambda: sdk.first_autopilot(PATIENCE))
    SCENARIOS[scenario](system, folder)
    os._exit(0)  # its threads may take long to end


if __name__ == "__main__":
    main(*sys.argv[1:])
