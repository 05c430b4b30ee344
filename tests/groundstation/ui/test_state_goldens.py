"""Empty, failed and lacking states of screens whose usual frames are in test_goldens.py, several in one app.

GOLDEN=write writes them anew; then read the diff.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import msgspec

from groundstation.snapshot import LinkView, Snapshot
from groundstation.views.base import View
from groundstation.views.files import FilesView, FolderRow
from groundstation.views.links import ControlView
from groundstation.views.messages import MessageRow, MessagesPage
from tests.groundstation.ui import golden_files
from tests.groundstation.ui.example_files import FILES, NO_TASKS
from tests.groundstation.ui.examples import MESSAGE_ROWS, MESSAGES_PAGE, snapshot, vehicle, waiting
from tests.groundstation.ui.link_examples import OURS, VIEWS
from tests.groundstation.ui.pilots import console

SMALL = (80, 24)
SILENT = (LinkView(name="udpin:0.0.0.0:14550"), LinkView(name="serial:/dev/ttyUSB0:57600"))
DAMAGED = LinkView(
    name="udpin:0.0.0.0:14550", frames=12, crc_errors=9,
    problem="messages arrive with another dialect's checksum: HEARTBEAT",
)  # fmt: skip
PROTECTED = FolderRow("/APM", problem="the vehicle protects it")
SENT = MessageRow(255, 190, True, "HEARTBEAT", 1.0, 17.0, 30, 0.3)
UNKNOWN = MessageRow(1, 1, False, "#11030", 0.2, 5.0, 98, 3.1, label="12 bytes", unknown=True)


@dataclass(frozen=True)
class Frame:
    """A state: the keys that open the screen, and what the station sends."""

    name: str
    keys: tuple[str, ...]
    picture: Snapshot
    views: tuple[View, ...] = ()


FRAMES = (
    Frame("drive_lost_80x24", (), snapshot(vehicle=vehicle(alive=False, silence=7.0))),
    Frame("messages_empty_80x24", ("f3",), msgspec.structs.replace(waiting(), links=SILENT),
          (MessagesPage((SENT,), 0, 1, 1, 1.0, 17.0),)),
    Frame("messages_damaged_80x24", ("f3",), msgspec.structs.replace(waiting(), links=(DAMAGED,)),
          (MessagesPage((SENT,), 0, 1, 1, 1.0, 17.0),)),
    Frame("messages_unknown_80x24", ("f3",), snapshot(),
          (msgspec.structs.replace(MESSAGES_PAGE, rows=(*MESSAGE_ROWS, UNKNOWN)),)),
    Frame("links_lacking_80x24", ("f7", "tab", "tab"), snapshot(),
          (*VIEWS[:2], ControlView(vehicle="ArduPilot rover 1", ours=OURS, driver=None))),
    Frame("files_no_logs_80x24", ("ctrl+g", "9"), snapshot(), (FilesView(system=2, name="Rover 2", logs=()), NO_TASKS)),
    Frame("files_refused_80x24", ("ctrl+g", "9", "tab"), snapshot(),
          (msgspec.structs.replace(FILES, folders=(FILES.folders[0], PROTECTED)), NO_TASKS)),
)  # fmt: skip


async def test_the_frames_are_the_golden_ones(tmp_path: Path) -> None:
    shown: dict[str, str] = {}
    async with console(SMALL, folder=tmp_path) as screen:
        for frame in FRAMES:
            await screen.go_home()
            await screen.press(*frame.keys)
            await screen.show(frame.picture)
            for view in frame.views:
                screen.station.offer_view(view)
            await screen.show(frame.picture)
            await screen.show(frame.picture)
            if frame.name.startswith("files_refused"):
                await screen.press("home", "down", "enter")
                await screen.show(frame.picture)
            shown[frame.name] = screen.text
    golden_files.check(shown)


def test_the_frames_fit_their_terminal() -> None:
    golden_files.check_sizes((frame.name, SMALL) for frame in FRAMES)
