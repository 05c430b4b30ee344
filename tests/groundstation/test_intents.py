"""Intents and the table of actions: complete, and equal on both sides of the pipe."""

from __future__ import annotations

import subprocess
import sys
from typing import Any, get_args

import msgspec

from groundstation.actions import ACTIONS
from groundstation.intents import replay
from groundstation.intents.base import Intent
from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.line import RunLine
from groundstation.intents.links import AddLink
from groundstation.intents.services import ServiceIntent
from groundstation.intents.session import Detach, GiveUpKeys, ReportScreen, StartSimulator
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle_intent import VehicleIntent
from groundstation.ipc import IntentBatch, decode_from_screen, encode
from groundstation.station.intent_handler import HANDLERS
from groundstation.station.station import Station
from tests.rows import each_row

REPLAY = {kind for kind in Intent.__subclasses__() if kind.__module__ == replay.__name__}
"""Handled by a replay (tests/groundstation/replay) and by no station."""

KINDS: tuple[type[Intent], ...] = get_args(AnyIntent)
VALUES: dict[str, Any] = {
    "key": "i", "throttle": 1, "steering": -1, "open": True, "style": "latch", "mode": "HOLD", "system": 3,
    "request": 5, "motor": 1, "endpoint": "udpin:127.0.0.1:14550", "link": 2, "path": "/logs/1.bin",
    "folder": "/tmp", "name": "1.bin", "screen": "map", "text": "mode HOLD", "file": "/tmp/1.bin", "log": 3,
    "seconds": -1.0, "read_at": 2.0, "messages": 5, "number": 7, "changes": (("FS_ACTION", 2.0),),
    "drives": True,
}  # fmt: skip
"""Field -> a value for fields without a default."""


def example(kind: type[Intent]) -> Intent:
    required = [field.name for field in msgspec.structs.fields(kind) if field.required]
    return kind(**{name: VALUES[name] for name in required})


@each_row("kind", KINDS, ids=lambda kind: kind.__name__)
def test_every_intent_travels_through_the_pipe(kind: type[Intent]) -> None:
    batch = IntentBatch(1.0, (example(kind),))
    assert decode_from_screen(encode(batch)) == batch


def test_every_intent_has_a_handler() -> None:
    shell = {StartSimulator, AddLink, RunLine, Detach, GiveUpKeys}
    assert {*Station(["memory"]).intents.kinds, ReportScreen, *shell, *REPLAY} == set(KINDS)
    assert not any(issubclass(kind, VehicleIntent) for kind in HANDLERS)


def test_what_moves_a_vehicle_is_dropped_when_late() -> None:
    late = {kind.__name__ for kind in KINDS if kind.valid_when_late}
    stops = {
        "EndPermission",
        "DeclineProposal",
        "Stop",
        "EmergencyStop",
        "Disarm",
        "DriveKeyUp",
        "ReleaseControl",
        "Quit",
        "Detach",
        "StopMotorTest",
    }
    assert late == stops | {
        "ReleasePad",
        "DriveByPicture",
        "SetKeyGate",
        "ReportKeyReleases",
        "ReportScreen",
        "Watch",
        "PinSeries",
        "AddLink",
    }


def test_what_the_screen_sends_on_its_own_is_no_input() -> None:
    own = {kind.__name__ for kind in KINDS if not kind.is_input}
    names = {"RenewLease", "SetKeyGate", "ReportKeyReleases", "ReportScreen", "Watch", "Quit", "Detach", "PinSeries"}
    assert own == names | {"DriveByPicture"}


def test_no_key_has_two_actions_and_drive_keys_differ() -> None:
    keys = [key for action in ACTIONS.values() for key in action.keys]
    assert len(keys) == len(set(keys))
    drives = [action.intent for action in ACTIONS.values() if isinstance(action.intent, DriveKeyDown)]
    assert len({(*each.directions, each.override) for each in drives}) == len(drives) == 13


def test_each_request_names_its_service_and_its_call() -> None:
    kinds = ServiceIntent.__subclasses__()
    assert len(kinds) > 20
    for kind in kinds:
        assert "" not in (kind.service, kind.what), kind
        assert kind.start is not ServiceIntent.start, kind


def test_intents_load_nothing_of_vehicles_or_the_dialect() -> None:
    code = "import sys, groundstation.intents.union; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "groundstation.intents.services" in loaded
    assert not [
        name for name in loaded if name.startswith(("groundstation.vehicles", "groundstation.station", "dialects"))
    ]
