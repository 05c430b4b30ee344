"""A pilot that lets an app do all that is due, in place of one that waits until the process has been idle for 20 ms.

Textual's pilot sends a message to each widget and then sleeps, after each key twice. In these waits, most of the time
of a test of a screen, the app goes on ticking and painting. Here a pause ends when the loop has nothing to call and the
screen nothing to lay out. What an app does later, by a timer or a thread, a test waits for by `tests.waits.until`.

Nobody sees what is painted between two pauses either: a headless app throws it away. So all that has changed is painted
once, at the end of a pause, or where the test asks for the frame (`painted_when_seen`).
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from weakref import WeakSet

import pytest
from textual import app as app_module
from textual._context import active_app
from textual.app import App
from textual.pilot import Pilot
from textual.screen import Screen

TURNS, ROUNDS = 20_000, 100
"""At most so many turns of a loop until it has nothing to call, and so many layouts until one changes nothing."""

STOCK: tuple[tuple[Any, str, Any], ...] = (
    (Pilot, "pause", Pilot.pause),
    (Pilot, "_wait_for_screen", Pilot._wait_for_screen),
    (app_module, "wait_for_idle", vars(app_module)["wait_for_idle"]),
    (Screen, "_compositor_refresh", Screen._compositor_refresh),
)
"""Textual's own."""

_painted_when_seen = WeakSet[App[Any]]()

paint: Callable[[Screen[Any]], None] = Screen._compositor_refresh
"""Paint what has changed on a screen, as Textual does."""


def share(patch: pytest.MonkeyPatch) -> None:
    """Let all pilots and the keys that they press pause by `settle`."""

    async def pause(pilot: Pilot[Any], delay: float | None = None) -> None:
        await asyncio.sleep(delay or 0.0)
        await settle(pilot.app)

    async def wait_for_screen(pilot: Pilot[Any], *_: object) -> bool:
        await settle(pilot.app)
        return not pilot.app._exception_event.is_set()

    async def wait_for_idle(*_: object) -> None:
        await settle(active_app.get())

    patch.setattr(Pilot, "pause", pause)
    patch.setattr(Pilot, "_wait_for_screen", wait_for_screen)
    patch.setattr(app_module, "wait_for_idle", wait_for_idle)
    patch.setattr(Screen, "_compositor_refresh", paint_later)


def restore(patch: pytest.MonkeyPatch) -> None:
    """Let pilots pause as Textual's do, and apps paint at once."""
    for owner, name, stock in STOCK:
        patch.setattr(owner, name, stock)


def paint_later(screen: Screen[Any]) -> None:
    """Leave what has changed on the screen on top of a headless app to the end of `settle`."""
    app = screen.app
    if not app.is_headless or screen is not app.screen:
        paint(screen)
        return
    screen._dirty_widgets.clear()
    app._update_mouse_over(screen)


async def settle(app: App[Any]) -> None:
    """Let an app do all that is due, and paint what that has changed."""
    for _ in range(ROUNDS):
        await _nothing_to_call()
        if app._exception_event.is_set() or not app.screen_stack:
            return
        screen: Screen[Any] = app.screen
        if app._resize_event is not None:  # Textual waits 8 ms for another one
            app._check_resize()
        elif _has_changed(screen):
            screen._on_timer_update()
        else:
            break
    if app not in _painted_when_seen:
        paint_changes(screen)


@contextmanager
def painted_when_seen(app: App[Any]) -> Iterator[None]:
    """Paint an app within the block only for `frames.cells` and by `paint_changes`."""
    _painted_when_seen.add(app)
    yield
    _painted_when_seen.discard(app)


def paint_changes(screen: Screen[Any]) -> None:
    """Paint what has changed on the screen on top since the last painting."""
    if screen._compositor._dirty_regions:
        paint(screen)


async def _nothing_to_call() -> None:
    """Return when the running loop has nothing to call but this coroutine."""
    ready = asyncio.get_running_loop()._ready  # type: ignore[attr-defined]
    for _ in range(TURNS):
        await asyncio.sleep(0)
        if not ready:
            return


def _has_changed(screen: Screen[Any]) -> bool:
    """Return whether a screen waits for its timer to lay out, to paint or to call what comes after that."""
    waits = bool(
        screen._layout_required
        or screen._scroll_required
        or screen._repaint_required
        or screen._recompose_required
        or screen._dirty_widgets
        or screen._callbacks
    )
    return waits and screen.is_current and not screen.app._batch_count
