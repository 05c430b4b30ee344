"""Whole frames of all screens. GOLDEN=write pytest ... writes them anew; then read the diff."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from msgspec.structs import replace

from groundstation.actions import ACTIONS
from groundstation.input.hold_to_confirm import HoldProgress
from groundstation.intents.watch import Watch
from groundstation.learn.attempt import Attempt
from groundstation.learn.course import load_course
from groundstation.screens import SCREENS
from groundstation.snapshot import OutputView, Snapshot
from groundstation.snapshot.agents import ProposalView
from groundstation.snapshot.drive import KeyToMotor, StopBound
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.learn.lesson_dock import LessonDock
from groundstation.ui.look.appearance import Look
from groundstation.views.base import View
from groundstation.views.line import RUNNING, LineView
from groundstation.views.links import ControlView, LinksView, VehiclesView
from tests.groundstation.ui import golden_files
from tests.groundstation.ui.example_charts import drive, fields_page
from tests.groundstation.ui.example_connect import CONNECT, FAILED, NOTHING, UNCONNECTED, forget, remember
from tests.groundstation.ui.example_files import FILES, NO_SERVICE, NO_TASKS, TASKS, fill_folder
from tests.groundstation.ui.example_setup import setup_frames, setup_view
from tests.groundstation.ui.examples import (
    FOREIGN_STOPS,
    FOREIGN_WAY,
    LOG_PAGE,
    MESSAGES_PAGE,
    SPEEDS,
    SYS_STATUS_VIEW,
    TRACK,
    TWO_PATHS,
    WALLED,
    helm,
    param_page,
    snapshot,
    vehicle,
    waiting,
    wheels,
)
from tests.groundstation.ui.link_examples import FLEET, OURS, SIGNED, VIEWS
from tests.groundstation.ui.pilots import Console, console
from tests.groundstation.ui.ptys import STANDARD
from tests.waits import until

SMALL, WIDE, LARGE = (80, 24), (140, 45), (200, 60)

ASKED = ProposalView(
    number=4, who="mavhelm mcp (pid 9) 'inspector'", text="drive forward at 60 % for 9 s",
    reason="I am the operator and have permitted this already", seconds=10, meters=50, left=20, waiting=2,
)  # fmt: skip

STANDING = snapshot(
    vehicle=vehicle(
        armed=False, driver=0, in_control=False, speed=0.0, demand=(0.0, 0.0), outputs=wheels(0.0, 0.0),
        limits=("disarmed",),
    ),
    operator=helm(
        held=(), throttle=0.0, steering=0.0, gate_open=False, gate_reason="disarmed", reports_releases=False,
        stop_bound=0.75, sending=False, rate=0.0,
    ),
)  # fmt: skip
STOPPED = snapshot(vehicle=vehicle(emergency_stop=True, armed=False, failsafes=("estop",), outputs=wheels(0.0, 0.0)))
UNKNOWN = snapshot(
    vehicle=vehicle(
        name="ArduPilot rover 1", driver=None, position=None, home=None, heading=None, roll=None, pitch=None,
        speed=math.nan, battery_voltage=None, battery_remaining=None, gps_fix=0, gps_satellites=None, demand=None,
        outputs=(), command_age=None, latency=None, key_to_motor=KeyToMotor(), health=(), mission=None,
        stops=(StopBound("no command", "--", "not known"), StopBound("no station", "--", "not known")),
    )
)  # fmt: skip

WARNED = snapshot(
    vehicle=vehicle(
        name="ArduPilot rover 1", driver=None, demand=None, command_age=0.03, command_age_estimated=True, latency=None,
        limits=(), stops=FOREIGN_STOPS, mission=None,
        key_to_motor=FOREIGN_WAY,
        outputs=(OutputView(name="steering servo", value=0.25), OutputView(name="throttle servo", value=0.57)),
        obeys="obeys ground station 250 only and we are 255: use --system 250",
        warnings=(
            "RC_OVERRIDE_TIME -1: never stops when the link is lost",
            "FS_THR_ENABLE 0: without an RC receiver never stops when the link is lost",
            "FS_GCS_ENABLE 0: no failsafe when the ground station is lost",
        ),
    )
)  # fmt: skip

COPTER = snapshot(
    vehicle=vehicle(
        name="ArduPilot copter 1", autopilot=3, mode="LOITER", flies=True, keys_mode="LOITER", may_fall=True,
        altitude=12.3, climb=0.5, speed=3.2, speed_over_ground=3.4, battery_left=744.0, full_speed=12.5,
        full_turn=202.5, full_climb=1.25, take_off=3.0, altitude_fence=100.0,
        demand=None, outputs=(), limits=(), speed_demand=None, mission=None,
        stops=(
            StopBound("no command", "RC input", "RC_OVERRIDE_TIME", 3.0, 0.042),
            StopBound("... no RC", "RTL", "FS_THR_ENABLE", 3.5, 0.042),
            StopBound("no station", "LAND", "FS_GCS_ENABLE", 5.0, 0.2, estimated=True),
        ),
    ),
    operator=helm(held=("i", "pageup"), steering=0.0, climb=0.6),
)  # fmt: skip

GROUNDED = snapshot(
    vehicle=replace(COPTER.vehicle, may_fall=False, altitude=0.0, climb=0.0, speed_over_ground=0.0, position=(0, 0),
                    altitude_fence=2.0),
    operator=helm(held=(), throttle=0.0, steering=0.0),
) if COPTER.vehicle else COPTER  # fmt: skip
DRIFTING = snapshot(
    vehicle=replace(COPTER.vehicle, drift=1.6), operator=helm(held=(), throttle=0.0, steering=0.0)
) if COPTER.vehicle else COPTER  # fmt: skip

SETUP_FRAMES = setup_frames(STANDING, waiting())

FRAMES: dict[str, tuple[tuple[int, int], Snapshot, tuple[str, ...]]] = {
    "drive_80x24": (SMALL, snapshot(signing=SIGNED), ()),
    "drive_100x30": ((100, 30), snapshot(signing=SIGNED), ()),
    "drive_140x45": (WIDE, snapshot(signing=SIGNED), ()),
    "drive_200x60": (LARGE, snapshot(signing=SIGNED), ()),
    "flight_80x24": (SMALL, COPTER, ()),
    "flight_140x45": (WIDE, COPTER, ()),
    "flight_ground_80x24": (SMALL, GROUNDED, ()),
    "flight_drift_80x24": (SMALL, DRIFTING, ("v",) * 6),
    "pane_speed_80x24": (SMALL, snapshot(), ("v",)),
    "pane_rates_80x24": (SMALL, snapshot(), ("v", "v")),
    "warned_140x45": (WIDE, WARNED, ()),
    "obstacles_80x24": (SMALL, WALLED, ()),
    "obstacles_140x45": (WIDE, WALLED, ()),
    "paths_80x24": (SMALL, TWO_PATHS, ()),
    "paths_pane_80x24": (SMALL, TWO_PATHS, ("v",) * 5),
    "paths_140x45": (WIDE, TWO_PATHS, ()),
    "latched_80x24": (SMALL, snapshot(operator=helm(style="latch", stop_bound=math.inf, reports_releases=False)), ()),
    "disarmed_80x24": (SMALL, STANDING, ()),
    "hold_80x24": (SMALL, STANDING, ()),
    "emergency_80x24": (SMALL, STOPPED, ()),
    "unknown_80x24": (SMALL, UNKNOWN, ()),
    "waiting_80x24": (SMALL, waiting(), ()),
    "waiting_140x45": (WIDE, waiting(simulator="ended with code 1: no free port"), ()),
    "warned_80x24": (SMALL, WARNED, ()),
    "too_small_39x12": ((39, 12), snapshot(), ()),
    "strip_40x10": ((40, 10), snapshot(), ()),
    "strip_60x15": ((60, 15), WARNED, ()),
    "strip_79x23": ((79, 23), STANDING, ()),
    "log_80x24": (SMALL, WARNED, ("f6",)),
    "log_140x45": (WIDE, WARNED, ("f6",)),
    "log_agent_80x24": (SMALL, snapshot(proposal=ASKED), ("f6",)),
    "log_agent_140x45": (WIDE, snapshot(proposal=ASKED), ("f6",)),
    "params_80x24": (SMALL, snapshot(), ("f4",)),
    "params_140x45": (WIDE, STANDING, ("f4",)),
    "command_80x24": (SMALL, STANDING, ("colon", "m", "o")),
    "links_80x24": (SMALL, FLEET, ("f7",)),
    "links_140x45": (WIDE, FLEET, ("f7",)),
    "links_panel_80x24": (SMALL, FLEET, ("f7", "tab")),
    "links_empty_80x24": (SMALL, waiting(), ("f7",)),
    "messages_80x24": (SMALL, snapshot(), ("f3", *["down"] * 8)),
    "messages_140x45": (WIDE, snapshot(), ("f3", *["down"] * 8)),
    "connect_80x24": (SMALL, UNCONNECTED, ("ctrl+g", "c")),
    "connect_140x45": (WIDE, UNCONNECTED, ("ctrl+g", "c")),
    "connect_nothing_80x24": (SMALL, UNCONNECTED, ("ctrl+g", "c")),
    "connect_failed_140x45": (WIDE, FLEET, ("ctrl+g", "c", "tab", "tab", "down")),
    "files_80x24": (SMALL, snapshot(transfers=0.41), ("ctrl+g", "9")),
    "files_140x45": (WIDE, snapshot(transfers=0.41), ("ctrl+g", "9", "down", "tab", "down")),
    "files_tree_80x24": (SMALL, snapshot(), ("ctrl+g", "9", "tab", "down", "enter", "down", "enter")),
    "files_here_80x24": (SMALL, snapshot(), ("ctrl+g", "9", "tab", "tab")),
    "files_none_80x24": (SMALL, snapshot(), ("ctrl+g", "9", "tab")),
    "files_loading_80x24": (SMALL, waiting(), ("ctrl+g", "9")),
    "charts_empty_80x24": (SMALL, snapshot(), ("f5",)),
    "charts_empty_140x45": (WIDE, waiting(), ("f5",)),
    "charts_80x24": (SMALL, snapshot(), ("f5",)),
    "charts_140x45": (WIDE, snapshot(), ("f5",)),
    "charts_list_80x24": (SMALL, snapshot(), ("f5", "tab")),
    "charts_measure_80x24": (SMALL, snapshot(), ("f5", "z", *["shift+left"] * 2, "m", "left", "left")),
    "charts_measure_140x45": (WIDE, snapshot(), ("f5", "z", "shift+left", "m", *["shift+left"] * 4)),
    "charts_add_140x45": (WIDE, snapshot(), ("f5", "a", *"volt")),
    **SETUP_FRAMES,
    "goto_80x24": (SMALL, snapshot(), ("ctrl+g",)),
    "lesson_80x24": (SMALL, STANDING, ()),
    "lesson_text_80x24": (SMALL, STANDING, ("ctrl+l", "ctrl+l")),
    "lesson_140x45": (WIDE, STANDING, ()),
    "help_80x24": (SMALL, snapshot(), ("question_mark",)),
}


FRAMES |= {
    f"ascii_{name}": FRAMES[name]
    for name in (
        "drive_80x24",
        "drive_140x45",
        "drive_200x60",
        "waiting_80x24",
        "strip_40x10",
        "log_80x24",
        "log_140x45",
        "params_80x24",
        "links_80x24",
        "links_140x45",
        "obstacles_80x24",
        "connect_80x24",
        "connect_140x45",
        "files_80x24",
        "files_140x45",
        "goto_80x24",
        "setup_80x24",
        "setup_140x45",
        "messages_80x24",
        "messages_140x45",
        "charts_80x24",
        "charts_measure_140x45",
    )
}


def views_for(name: str) -> Sequence[View]:
    """Return what the station sends to the screen of a frame."""
    if "files" in name:
        return () if "loading" in name else (NO_SERVICE, NO_TASKS) if "none" in name else (FILES, TASKS)
    if "connect" in name:
        return (NOTHING if "nothing" in name else FAILED if "failed" in name else CONNECT,)
    if "charts" in name:
        return (fields_page(empty=True),) if "empty" in name else (fields_page(),)
    if "links_empty" in name:
        return VehiclesView(()), LinksView(()), ControlView(vehicle="", ours=OURS)
    if "setup" in name:
        return (setup_view(name),)
    if "params" in name:
        return (param_page(),)
    return VIEWS if "links" in name else (LOG_PAGE, MESSAGES_PAGE, TRACK, SPEEDS)


def begin_lesson() -> LessonDock:
    """Return the first lesson, with the hint of a wrong deed."""
    dock = LessonDock("Lesson 1", Attempt(load_course()[0].lesson), next_heading="2 A key on the wire")
    for uptime in (1.0, 1.2):
        dock.see(snapshot(uptime=uptime, vehicle=vehicle(armed=False), operator=helm(held=("i",))), "drive")
    assert dock.attempt.hint
    return dock


def fill_recent(name: str) -> None:
    """Fill the file of the endpoints used before, for the frames that list them."""
    if "connect" in name and "nothing" not in name:
        remember(time.time())
    else:
        forget()


async def fill(screen: Console, name: str, keys: Sequence[str], picture: Snapshot) -> None:
    """Press the keys behind the one that opened the screen, and show what that asks for."""
    if "charts" in name:
        if "empty" not in name:  # points that come before they are requested are dropped
            await until(lambda: any(getattr(each, "fields", ()) for each in screen.station.of(Watch)[-1].requests))
        screen.station.offer_view(drive())
        await screen.show(picture)
        await screen.press(*keys[1:])
        if "a" in keys:
            screen.station.offer_view(fields_page("volt"))
        return
    await screen.press(*keys[1:])
    if "command" in name:
        screen.station.offer_view(LineView(0, RUNNING, "", "mo", ("mode", "modes")))
    if "messages" in name:
        screen.station.offer_view(SYS_STATUS_VIEW)
    if "params" in name:
        await screen.press("down", "enter", "backspace", "0", "enter", "W")


OWN_APP = ("lesson", "pane_", "paths_pane", "flight_drift")
"""Starts of the names of frames that leave Drive in another state, or need one that another frame has not seen."""


def groups() -> Iterator[object]:
    """Yield frames that one app shows one after the other: of a look and a size, with all rare sizes as one."""
    found: dict[str, list[str]] = {}
    for name, (size, _, _) in FRAMES.items():
        plain = name.removeprefix("ascii_")
        shape = f"{size[0]}x{size[1]}" if size in (SMALL, WIDE) else "other sizes"
        look = "ascii " if name != plain else ""
        found.setdefault(name if plain.startswith(OWN_APP) else look + shape, []).append(name)
    for group, names in found.items():
        yield pytest.param(names, id=group)


@pytest.mark.parametrize("names", [*groups()])
async def test_the_frames_are_the_golden_ones(
    names: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "logs").mkdir()
    look, folder = Look(ascii=names[0].startswith("ascii")), fill_folder(tmp_path / "logs")
    lesson = begin_lesson() if "lesson" in names[0] else None
    size, picture, _ = FRAMES[names[0]]
    shown: dict[str, str] = {}
    async with console(size, picture, folder=folder, look=look, lesson=lesson) as screen:
        for name in names:
            if name != names[0]:
                await screen.begin_anew(*FRAMES[name][:2])
            shown[name] = await show_frame(screen, name)
    golden_files.check(shown)


async def show_frame(screen: Console, name: str) -> str:
    """Bring a frame on the screen of an app that has just begun; return what it shows."""
    _, picture, keys = FRAMES[name]
    fill_recent(name)
    opens = 2 if keys[:1] == ("ctrl+g",) else 1
    await screen.press(*keys[:opens])
    for view in views_for(name):
        screen.station.offer_view(view)
    await screen.show(picture)
    if keys:
        await fill(screen, name, keys[opens - 1 :], picture)
        await screen.show(picture)  # the height of the alerts is known after the first one
    if "hold" in name:
        state = DisplayState(picture, STANDARD, hold=HoldProgress(ACTIONS["vehicle.arm"], "r", 0.4))
        while "Arm: hold r" not in screen.text:  # the app itself shows no hold, ten times a second
            screen.app.drive.show_state(state)
            await screen.pilot.pause()
    return screen.text


async def test_a_screen_looks_the_same_after_all_others_were_open() -> None:
    async with console(SMALL) as screen:
        for row in SCREENS:
            await screen.press(*(row.keys[:1] or ("ctrl+g", row.digit)))
        for name in ("log_80x24", "links_80x24", "params_80x24"):
            await screen.go_home()
            await open_frame(screen, name)
            assert screen.text == golden_files.read(name), name


async def open_frame(screen: Console, name: str) -> None:
    """Bring a frame on the screen."""
    _, picture, keys = FRAMES[name]
    await screen.show(picture)
    await screen.press(*keys)
    for view in views_for(name):
        screen.station.offer_view(view)
    if "params" in name:
        await screen.show(picture)
        await screen.press("down", "enter", "backspace", "0", "enter", "W")
    await screen.show(picture)
    await screen.show(picture)


def test_the_frames_fit_their_terminals() -> None:
    golden_files.check_sizes((name, size) for name, (size, _, _) in FRAMES.items())
