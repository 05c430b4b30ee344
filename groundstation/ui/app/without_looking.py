"""For operators who do not look at the screen: speech, the bell, and the terminal's cursor on the focused row."""

from __future__ import annotations

from typing import Any

import msgspec
from textual.app import App
from textual.geometry import Offset
from textual.screen import Screen
from textual.widgets import Input

from groundstation.snapshot import Snapshot
from groundstation.speech.announcements import Announcement, Priority, is_worth_saying, spoken_state, text_announcement
from groundstation.speech.voice import Voice
from groundstation.ui.terminal.painting import visible_regions
from groundstation.ui.widgets.instrument import Instrument

SHOW_CURSOR = "\x1b[?25h"


class Aids(msgspec.Struct, frozen=True):
    """What the user has chosen."""

    speak: bool = False
    bell: bool = False
    cursor: bool = False
    """The terminal's cursor is visible. It is on the focused row in any case, where screen readers look for it."""


class WithoutLooking:
    """Follows the snapshots of an app."""

    def __init__(self, app: App[Any], aids: Aids) -> None:
        self._app, self._aids = app, aids
        self._voice = Voice.open(speak=aids.speak, ring=app.bell if aids.bell else None)
        self._asked = 0
        """System id of the ground station whose request for control was said."""
        self._newest_text: int | None = None

    def handle_snapshot(self, snapshot: Snapshot) -> None:
        """Say what is new."""
        vehicle = snapshot.vehicle
        self._voice.update(None if vehicle is None else spoken_state(vehicle), self._texts(snapshot))
        asks = snapshot.handover.station if snapshot.handover is not None else 0
        if asks and asks != self._asked:
            self._voice.say(Announcement(Priority.URGENT, f"ground station {asks} asks for control"))
        self._asked = asks

    def handle_outage(self, text: str) -> None:
        """Say that the station has ended or hangs, or "" that it answers again."""
        self._voice.say(Announcement(Priority.URGENT, text or "the station answers again"))

    def switch_mute(self) -> str:
        """Be silent, or speak again; return what to tell."""
        if not self._voice.speaks:
            return "nothing is spoken: start with --speak"
        return "speech is muted" if self._voice.switch_mute() else "speech is on"

    @property
    def muted(self) -> bool:
        """Whether speech was asked for and is silent."""
        return self._voice.muted

    def place_cursor(self, screen: Screen[Any]) -> None:
        """Put the terminal's cursor on the focused row; a text field has it already."""
        if isinstance(screen.focused, Input):
            return
        place = find_cursor(screen)
        if place is None or place == self._app.cursor_position:
            return
        self._app.cursor_position = place
        if self._aids.cursor and self._app._driver is not None:
            self._app._driver.write(SHOW_CURSOR)

    def close(self) -> None:
        """End what is being said."""
        self._voice.close()

    def _texts(self, snapshot: Snapshot) -> list[Announcement]:
        """Return those of the vehicle that have come since the last snapshot; those before the first are old."""
        newest = max((line.number for line in snapshot.texts), default=0)
        known, self._newest_text = self._newest_text, max(newest, self._newest_text or 0)
        return [
            text_announcement(line.severity, line.text)
            for line in snapshot.texts
            if known is not None and line.number > known and line.label == "vehicle" and is_worth_saying(line.severity)
        ]


def find_cursor(screen: Screen[Any]) -> Offset | None:
    """Return where a list draws its cursor, in cells of the terminal; None where no list has one."""
    for each, region in visible_regions(screen):
        line = each.cursor_line() if isinstance(each, Instrument) else None
        if line is not None:
            return region.shrink(each.styles.gutter).offset + Offset(0, line)
    return None
