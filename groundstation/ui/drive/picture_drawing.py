"""Draws the newest picture of a feed in the widgets of a screen, whenever the terminal may have one."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence

from msgspec.structs import replace
from textual.screen import Screen

from groundstation.ui.drive.camera_feed import CameraFeed, CameraValue
from groundstation.ui.drive.instruments.camera import CameraPicture
from groundstation.ui.terminal.painting import painted_at_once
from groundstation.views.camera import CameraView


class PictureDrawing:
    """One screen. `value` returns what its widgets show now."""

    def __init__(self, screen: Screen[None], feed: CameraFeed, value: Callable[[], CameraValue]) -> None:
        self._screen, self._feed, self._value = screen, feed, value
        self._output = feed.output
        self._late: asyncio.TimerHandle | None = None
        """A picture waits until the terminal may have it. Not a timer of Textual, which takes a task and messages."""
        self._pictures: Sequence[CameraPicture] = ()

    @property
    def waits(self) -> bool:
        """A picture is to be drawn as soon as the terminal may have one: the newest one then."""
        return self._late is not None

    def follow(self, view: CameraView | None, pictures: Sequence[CameraPicture]) -> None:
        """Decode the stream of a view at the size of the widgets that show it; without them nothing runs."""
        if not pictures or view is None:
            self._feed.update(None, (0, 0))
            return
        protocol = self._value().protocol
        self._feed.update(view, pictures[0].fit(protocol, self._output.answers.cell))

    def show(self, pictures: Sequence[CameraPicture]) -> bool:
        """Draw the newest picture, or later if the terminal may not have it yet. Return whether it was drawn."""
        self._pictures = pictures
        if not pictures or self._late is not None:
            return False
        if wait := self._output.wait():  # the last one before the stream stands still is drawn, too
            self._late = asyncio.get_running_loop().call_later(wait, self._show_late)
            return False
        self._feed.choose_newest()
        value, sizes = self._value(), dict[int, int]()

        def size_of(level: int) -> int:
            if level not in sizes:
                sizes[level] = sum(each.measure(replace(value, level=level)) for each in pictures)
            return sizes[level]

        self._output.choose_level(size_of, pictures[0].coarsest(value.protocol))
        size = size_of(self._output.level)
        if self._output.level != value.level:
            value = self._value()
        with painted_at_once(self._screen):
            for each in pictures:
                each.show(value)
        self.draw_pixels(pictures)
        self._output.note_frame(size)
        return True

    def _show_late(self) -> None:
        self._late = None
        if not self._screen.is_running:
            return
        try:
            self._feed.report()
        except Exception as error:
            self._screen.app._handle_exception(error)

    def draw_pixels(self, pictures: Sequence[CameraPicture]) -> None:
        """Draw what stands over the cells of the widgets, where it has changed; remove it from the others."""
        for each in {*self._pictures, *pictures}:
            shown = each in pictures and self._screen.is_current
            self._output.write(each.overlay(self._output.answers.cell) if shown else each.uncover())

    def stop(self) -> None:
        """End the decoder, and remove what stands over the cells."""
        self._feed.stop()
        if self._late is not None:
            self._late.cancel()
            self._late = None
        for each in self._pictures:
            self._output.write(each.uncover())
