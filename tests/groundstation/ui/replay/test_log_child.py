"""Logs that are opened from the running app: when that is refused, and the command that shows them."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from groundstation.cli.local.replay import build_replay_parser
from groundstation.cli.options import REPLAY_SETTINGS, option_words
from groundstation.config.settings import Settings, ThemeName
from groundstation.snapshot import RecordingView, ReplayStatus, Snapshot
from groundstation.ui.replay.log_child import ARMED, IN_REPLAY, NO_LOG, NO_TERMINAL, find_refusal, replay_command
from tests.groundstation.replay.logs import drive_log
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.pilots import console

LOG = Path("/logs/drive.tlog")
REPLAY = ReplayStatus(file="a.tlog", wall=0.0, position=0.0, duration=1.0)

REFUSED: dict[str, tuple[Snapshot, Path | None, str]] = {
    "not armed": (snapshot(vehicle=vehicle(armed=False)), LOG, ""),
    "armed by somebody else": (snapshot(vehicle=vehicle(armed=True, in_control=False)), LOG, ""),
    "driven from here": (snapshot(vehicle=vehicle(armed=True, in_control=True)), LOG, ARMED),
    "another one left armed": (snapshot(vehicle=None, left_armed=("2 Rover is left ARMED",)), LOG, ARMED),
    "in a replay": (snapshot(vehicle=None, replay=REPLAY), LOG, IN_REPLAY),
    "another file": (snapshot(vehicle=None), LOG.with_suffix(".bin"), NO_LOG),
    "no file": (snapshot(vehicle=None), None, NO_LOG),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_log_is_refused_while_a_vehicle_is_armed_from_here(name: str) -> None:
    now, file, expected = REFUSED[name]
    assert find_refusal(now, file) == expected


def test_command_has_this_runs_settings_and_the_verb_takes_it() -> None:
    settings = Settings(theme=ThemeName.LIGHT, ascii=False, reduce_motion=True, folder="/logs", keymap="teleop")
    command = replay_command(Path("/logs/-odd.tlog"), "12:04:10", option_words(settings, REPLAY_SETTINGS))
    assert command[:4] == [sys.executable, "-m", "groundstation", "replay"]
    given = build_replay_parser().parse_args(command[4:])
    assert (given.file, given.at, given.folder, given.keymap) == (
        Path("/logs/-odd.tlog"), "12:04:10", "/logs", "teleop",
    )  # fmt: skip
    assert (given.theme, given.ascii, given.reduce_motion, given.log_file) == ("light", False, True, None)
    assert option_words(Settings(keymap="teleop", keys={"app.quit": ["q"]}), REPLAY_SETTINGS) == []


OPENING: dict[str, tuple[str, ...]] = {
    "files": ("ctrl+g", "9", "tab", "tab", "o"),
    "replay": ("ctrl+g", "0", "enter"),
    "log": ("f6", "o"),
}


@pytest.mark.parametrize("screen_name", OPENING)
async def test_each_screen_says_why_it_opens_no_log(tmp_path: Path, screen_name: str) -> None:
    (tmp_path / "drive.tlog").write_bytes(bytes(drive_log(15).data))
    recording = RecordingView(path=str(tmp_path / "drive.tlog"))
    async with console((140, 45), folder=tmp_path) as screen:
        await screen.show(snapshot(vehicle=vehicle(armed=True, in_control=True), recording=recording))
        await screen.press(*OPENING[screen_name])
        assert ARMED in screen.text
        await screen.show(snapshot(vehicle=vehicle(armed=False), recording=recording))
        await screen.press(OPENING[screen_name][-1])
        assert NO_TERMINAL in screen.text  # the log is found: only the test has no terminal to lend
