"""SERVICE_CALLS: how each request of the operator is made to the services of a vehicle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec

from dialects.enums import Command, MissionType
from groundstation.formats.plan import Plan, PlannedHome, for_vehicle
from groundstation.intents.files import (
    CompareFile,
    EraseLogs,
    GetFile,
    GetLog,
    ListFolder,
    ListLogs,
    PutFile,
    RemoveFile,
)
from groundstation.intents.plan import (
    ChooseMode,
    ClearPlan,
    DownloadPlan,
    EnableFence,
    GoTo,
    JumpToItem,
    PauseMission,
    SetHome,
    StartMission,
    UploadPlan,
)
from groundstation.intents.services import (
    CompareParams,
    FetchParams,
    RequestMessage,
    ResetParams,
    ServiceIntent,
    SetMessageRate,
    StoreParams,
    WriteParams,
)
from groundstation.intents.setup import Calibrate, EndCalibration, RebootVehicle, RunChecks
from groundstation.vehicles.calibration.calibration import CANCEL, KINDS, REQUEST, WRITE
from groundstation.vehicles.services import VehicleServices
from link.services.mission.items import Items, MissionItem


class ServiceCall(msgspec.Struct, frozen=True):
    """How an intent becomes a request."""

    service: str
    """Name of the service, by which screens tell their requests from others: RequestLine.service."""
    what: str
    """What is requested, for the case that there is no vehicle."""
    make: Callable[[VehicleServices, Any, float], None]
    """Called with the services of the vehicle, the intent and the time."""


SETUP = "setup"
"""The service of the requests of the Setup screen."""

AUTOPILOT = 1.0
"""Parameter 1 of PREFLIGHT_REBOOT_SHUTDOWN: restart the autopilot, not its computer."""


def _command(what: str, command: Command, *params: float) -> ServiceCall:
    """Return a call that is one command."""
    return ServiceCall(
        SETUP, what, lambda services, intent, now: services.commands.send(intent.request, command, params, what, now)
    )


def _calibrate(services: VehicleServices, intent: Calibrate, now: float) -> None:
    kind = KINDS[intent.kind]
    services.commands.send(intent.request, kind.command, kind.params, f"{REQUEST}{intent.kind}", now)


def _end_calibration(services: VehicleServices, intent: EndCalibration, now: float) -> None:
    command, what = (Command.DO_ACCEPT_MAG_CAL, WRITE) if intent.accept else (Command.DO_CANCEL_MAG_CAL, CANCEL)
    services.commands.send(intent.request, command, (0,), f"{REQUEST}{what}", now)


def _upload(services: VehicleServices, intent: UploadPlan, now: float) -> None:
    items = tuple(
        MissionItem(each.command, each.frame, each.params, each.x, each.y, each.z, each.autocontinue)
        for each in intent.items
    )
    home = (
        PlannedHome(intent.home.latitude, intent.home.longitude, intent.home_altitude)
        if intent.home is not None
        else None
    )
    kind = MissionType(intent.kind)
    plan = _PLANS[kind](items, home)
    services.plans.upload(intent.request, kind, for_vehicle(plan, kind, services.autopilot), now)


_PLANS: dict[MissionType, Callable[[Items, PlannedHome | None], Plan]] = {
    MissionType.MISSION: lambda items, home: Plan(mission=items, home=home),
    MissionType.FENCE: lambda items, _: Plan(fence=items),
    MissionType.RALLY: lambda items, _: Plan(rally=items),
}


SERVICE_CALLS: dict[type[ServiceIntent], ServiceCall] = {
    FetchParams: ServiceCall(
        "params", "fetch parameters", lambda services, intent, now: services.params.fetch(intent.request, now)
    ),
    WriteParams: ServiceCall(
        "params",
        "set parameters",
        lambda services, intent, now: services.param_writer.write(intent.request, intent.changes, now),
    ),
    DownloadPlan: ServiceCall(
        "plan",
        "download a plan",
        lambda services, intent, now: services.plans.download(intent.request, MissionType(intent.kind), now),
    ),
    UploadPlan: ServiceCall("plan", "upload a plan", _upload),
    ClearPlan: ServiceCall(
        "plan",
        "clear a plan",
        lambda services, intent, now: services.plans.clear(intent.request, MissionType(intent.kind), now),
    ),
    StartMission: ServiceCall(
        "plan", "start the mission", lambda services, intent, now: services.missions.start(intent.request, now)
    ),
    PauseMission: ServiceCall(
        "plan", "pause the mission", lambda services, intent, now: services.missions.pause(intent.request, now)
    ),
    JumpToItem: ServiceCall(
        "plan",
        "jump to an item",
        lambda services, intent, now: services.missions.jump(intent.request, intent.index, now),
    ),
    EnableFence: ServiceCall(
        "plan",
        "switch the fence",
        lambda services, intent, now: services.commands.send(
            intent.request, Command.DO_FENCE_ENABLE, (float(intent.on),), f"fence {'on' if intent.on else 'off'}", now
        ),
    ),
    GoTo: ServiceCall(
        "plan",
        "go to a place",
        lambda services, intent, now: services.missions.go_to(
            intent.request, intent.place.latitude, intent.place.longitude, now
        ),
    ),
    SetHome: ServiceCall(
        "plan",
        "set home",
        lambda services, intent, now: services.missions.set_home(
            intent.request, intent.place.latitude, intent.place.longitude, now
        ),
    ),
    ChooseMode: ServiceCall(
        "plan",
        "change the mode",
        lambda services, intent, now: services.modes.set(intent.request, intent.mode, now),
    ),
    CompareParams: ServiceCall(
        "params",
        "compare parameters",
        lambda services, intent, now: services.param_file.open(intent.request, intent.name, intent.text, now),
    ),
    StoreParams: ServiceCall(
        "params", "store parameters", lambda services, intent, now: services.param_storage.store(intent.request, now)
    ),
    ResetParams: ServiceCall(
        "params", "reset parameters", lambda services, intent, now: services.param_storage.reset(intent.request, now)
    ),
    ListFolder: ServiceCall(
        "folders",
        "list a folder",
        lambda services, intent, now: services.folders.list_folder(intent.request, intent.path, now),
    ),
    GetFile: ServiceCall(
        "files",
        "download a file",
        lambda services, intent, now: services.transfers.get_file(
            intent.request, intent.path, intent.folder, intent.name, now, overwrite=intent.overwrite
        ),
    ),
    PutFile: ServiceCall(
        "files",
        "upload a file",
        lambda services, intent, now: services.transfers.put_file(intent.request, intent.path, intent.file, now),
    ),
    RemoveFile: ServiceCall(
        "files",
        "remove a file",
        lambda services, intent, now: services.files.remove(intent.request, intent.path, now),
    ),
    CompareFile: ServiceCall(
        "files",
        "compare a file",
        lambda services, intent, now: services.comparing.compare(intent.request, intent.path, intent.file, now),
    ),
    ListLogs: ServiceCall(
        "folders", "list logs", lambda services, intent, now: services.logs.list_logs(intent.request, now)
    ),
    GetLog: ServiceCall(
        "files",
        "download a log",
        lambda services, intent, now: services.transfers.get_log(
            intent.request, intent.log, intent.folder, intent.name, now, overwrite=intent.overwrite
        ),
    ),
    EraseLogs: ServiceCall(
        "files", "erase all logs", lambda services, intent, now: services.logs.erase(intent.request, now)
    ),
    SetMessageRate: ServiceCall(
        "messages",
        "set the rate of a message",
        lambda services, intent, now: services.messages.set_rate(
            intent.request, intent.component, intent.message, intent.name, intent.rate, now
        ),
    ),
    RequestMessage: ServiceCall(
        "messages",
        "request a message",
        lambda services, intent, now: services.messages.request_once(
            intent.request, intent.component, intent.message, intent.name, now
        ),
    ),
    RunChecks: _command("pre-arm checks", Command.RUN_PREARM_CHECKS),
    RebootVehicle: _command("reboot", Command.PREFLIGHT_REBOOT_SHUTDOWN, AUTOPILOT),
    Calibrate: ServiceCall(SETUP, "calibrate", _calibrate),
    EndCalibration: ServiceCall(SETUP, "end a calibration", _end_calibration),
}
"""Intent -> call."""
