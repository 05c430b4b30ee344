"""Frames of the Replay screen, and what its keys do, with a real desk. GOLDEN=write writes them anew."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from groundstation.intents.driving import DriveKeyDown, SetStyle
from groundstation.intents.vehicle import Arm
from groundstation.replay.log_replay import LogReplay
from groundstation.ui.keys.key_gate import OTHER_SCREEN, REPLAY
from groundstation.ui.look.appearance import Look
from groundstation.ui.replay.timeline import tick_times
from groundstation.ui.widgets.chart import Chart
from tests.groundstation.replay.logs import drive_log, keys_log, open_desk
from tests.groundstation.ui.examples import snapshot
from tests.groundstation.ui.pilots import console
from tests.groundstation.ui.replay_station import replay_console

GOLDEN = Path(__file__).parent / "golden"
SMALL, WIDE = (80, 24), (140, 45)

FRAMES: dict[str, tuple[tuple[int, int], str, tuple[str, ...]]] = {
    "replay_80x24": (SMALL, "replay", ()),
    "replay_140x45": (WIDE, "replay", ("m", "shift+right", "m", "up", "up")),
    "ascii_replay_140x45": (WIDE, "replay", ()),
    "replay_damaged_140x45": (WIDE, "replay", ()),
    "replay_drive_80x24": (SMALL, "drive", ()),
}


def damaged(data: bytes) -> bytes:
    """Return the log with 300 bytes of zeros in it, and cut off."""
    return data[:9000] + bytes(300) + data[9300:-7]


def open_drive(*, hurt: bool = False) -> LogReplay:
    """Return a replay at 35 s of a drive, in AUTO."""
    data = bytes(drive_log().data)
    return open_desk(damaged(data) if hurt else data, at="35")


@pytest.mark.parametrize("name", FRAMES)
async def test_the_frame_is_the_golden_one(name: str) -> None:
    size, first, keys = FRAMES[name]
    look = Look(ascii=name.startswith("ascii"), reduce_motion=True)
    async with replay_console(open_drive(hurt="damaged" in name), size, first=first, look=look) as screen:
        if keys:
            await screen.press(*keys)
        shown = re.sub(r"tty +\S+ ms ", "", screen.text)
    file = GOLDEN / f"{name}.txt"
    if os.environ.get("GOLDEN") == "write":
        file.write_text(shown, "utf-8")
    assert shown == file.read_text("utf-8")
    assert "REPLAY" in shown.splitlines()[0]


async def test_the_map_says_that_the_log_has_no_plan_yet() -> None:
    async with replay_console(open_drive(), WIDE, first="map") as screen:
        for _ in range(100):
            if "no mission in the log yet" in screen.text:
                break
            await screen.show(times=1)
        assert "no mission in the log yet" in screen.text
        assert "not loaded" not in screen.text


async def test_without_a_log_the_logs_here_are_listed(tmp_path: Path) -> None:
    (tmp_path / "drive.tlog").write_bytes(bytes(drive_log(40).data))
    (tmp_path / "flight.bin").write_bytes(b"x")
    async with console(SMALL, folder=tmp_path) as screen:
        await screen.press("ctrl+g", "0")
        await screen.show(snapshot())
        assert "drive.tlog" in screen.text
        assert "flight.bin" not in screen.text
        assert "mavhelm replay FILE" in screen.text
        assert "REPLAY" not in screen.text


async def test_the_keys_move_in_the_log() -> None:
    async with replay_console(open_drive(), SMALL) as screen:
        player = screen.station.desk.player
        await screen.press("right", "right", "shift+left")
        assert player.position == pytest.approx(27.0)
        await screen.press("n")
        assert player.position == pytest.approx(30.0)
        await screen.press("N")
        assert player.position == pytest.approx(20.0)
        await screen.press("colon", *"0:41", "enter")
        assert player.position == pytest.approx(41.0)
        await screen.press("slash", *"MODE==AUTO", "enter")
        assert player.position == pytest.approx(30.0)
        await screen.press("down", "down", "enter")
        assert player.position == pytest.approx(50.0)
        await screen.press("comma")
        assert player.position < 50.0
        await screen.press("greater_than_sign", "greater_than_sign", "p")
        assert (player.speed, player.playing) == (4.0, True)
        await screen.press("space")
        assert not player.playing


async def test_no_key_drives_or_commands_on_any_screen() -> None:
    async with replay_console(open_drive(), SMALL, first="drive") as screen:
        await screen.press("i", "r", "1", "tab", "t")
        assert screen.app.gate.closure == REPLAY
        sent = [type(intent) for intent in screen.station.screen.intents]
        assert Arm not in sent
        assert SetStyle not in sent
        assert DriveKeyDown in sent  # the station would know them to ignore them; a replay does nothing with them
        assert screen.station.desk.player.station.operator.sent_demand.throttle == 0.5  # that of the log
        for key in ("f2", "f3", "f4", "f5", "f6", "f7", "f8"):
            await screen.press(key)
            assert screen.app.gate.closure == OTHER_SCREEN
            assert "REPLAY" in screen.text.splitlines()[0]


async def test_a_request_says_that_nothing_is_sent() -> None:
    async with replay_console(open_drive(), SMALL, first="files") as screen:
        await screen.press("R")
        assert "replay: nothing is sent to a vehicle" in screen.text


async def test_a_chart_shows_the_log_and_forgets_it_after_a_move() -> None:
    async with replay_console(open_drive(), WIDE, first="charts") as screen:
        await screen.show()
        assert "groundspeed" in screen.text
        await screen.press("ctrl+g", "0")
        await screen.press("colon", *"0:15", "enter")
        await screen.press("f5")
        await screen.show()
        assert "groundspeed 14.90" in screen.text


async def test_the_caps_of_the_recorded_keys_are_lit() -> None:
    async with replay_console(open_desk(bytes(keys_log().data), at="5"), WIDE) as screen:
        for at, held in (("05", "none"), ("12", "i"), ("17", "i u"), ("25", "i"), ("31", "none")):
            await screen.press("colon", *f"0:{at}", "enter")
            await screen.show()
            assert re.search(rf"held {held} +│", screen.text), at
            assert set(screen.app.drive.snapshot.operator.held) == {*held.split()} - {"none"}, at


async def test_the_screens_that_were_looked_at_are_no_events() -> None:
    async with replay_console(open_desk(bytes(keys_log().data), at="5"), WIDE) as screen:
        await screen.show()
        assert " KEY   i" in screen.text
        assert " GCS " not in screen.text


async def test_the_text_of_an_event_that_is_cut_is_whole_in_the_hint() -> None:
    text = "neutral, no repeat of a key that was held for a long time"
    async with replay_console(open_desk(bytes(keys_log().data), at="5"), SMALL) as screen:
        await screen.show()
        assert text not in screen.text
        assert "…" in screen.text
        await screen.press(*["down"] * 6)
        assert f"of 6: {text}" in screen.text


async def test_the_speed_chart_of_drive_has_the_time_before_a_seek() -> None:
    async with replay_console(open_drive(), WIDE, first="drive") as screen:
        await screen.press("ctrl+g", "0")
        await screen.press("colon", *"0:45", "enter")
        await screen.press("f1")
        await screen.show()
        chart = screen.app.drive.query_one("#speeds", Chart)
        assert chart.value.shown[0][0] < chart.value.shown[-1][0] - 20.0


def test_the_axis_has_times_that_people_count_in() -> None:
    assert tick_times(59.0, 120) == [10.0, 20.0, 30.0, 40.0, 50.0]
    assert tick_times(126.0, 60) == [60.0, 120.0]
    assert tick_times(3725.0, 120) == [600.0 * number for number in range(1, 7)]
    assert tick_times(400_000.0, 60) == [36 * 3600.0 * number for number in range(1, 4)]
    assert tick_times(0.0, 60) == []
