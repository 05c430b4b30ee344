"""The picture of the Map screen: a mission is drawn, uploaded and half driven, with a fence and a rally point."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from textual.pilot import Pilot

from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.map.model import MapModel
from groundstation.ui.map.screen import MapScreen
from groundstation.views.plan import PlanKind
from tests.groundstation.ui import frames

MISSION = ((4.0, 0.6), (4.4, 3.4), (0.4, 3.0), (0.6, 6.2), (4.4, 6.6))
FENCE = ((-2.2, -2.0), (6.6, -1.4), (6.8, 5.4), (4.8, 9.6), (-2.4, 9.0))
EXCLUDED, RALLY, ADDED = (2.4, 4.9), (-1.2, 7.6), (0.8, 8.2)
FENCE_QUESTION = "switched off: switch it on"
Wait = Callable[[Callable[[], bool]], Awaitable[None]]


async def map_picture(app: ConsoleApp, pilot: Pilot[int], wait: Wait) -> frames.Picture:
    """Return the screen while AUTO drives, with two edits that are not uploaded."""
    await pilot.press("f2")
    await wait(lambda: isinstance(app.screen, MapScreen))
    screen = app.screen
    assert isinstance(screen, MapScreen)
    model = screen._model
    await wait(lambda: set(model.copies.items) == set(PlanKind) and model.home is not None)
    await _draw(pilot, model, MISSION)
    await _upload(pilot, model, wait)
    await pilot.press("e")
    await _draw(pilot, model, (*FENCE, EXCLUDED))
    await pilot.press("tab", "tab", "enter", *"circle out", "enter", "down", "down", "down", "down", "enter", "end")
    await pilot.press("backspace", "1", "enter", *["tab"] * 1)
    await _upload(pilot, model, wait)
    await wait(lambda: FENCE_QUESTION in frames.text(app))
    await pilot.press("y")
    await wait(lambda: FENCE_QUESTION not in frames.text(app))
    await pilot.press("e")
    await _draw(pilot, model, (RALLY,))
    await _upload(pilot, model, wait)
    await pilot.press("e", "P", "y")
    await wait(lambda: model.view is not None and model.view.current == 3 and 2 in model.view.reached)
    model.editor.select(4)
    await _draw(pilot, model, (ADDED,))
    await pilot.press("f")
    await pilot.pause(4.0)
    return frames.cells(app)


async def _draw(pilot: Pilot[int], model: MapModel, points: tuple[tuple[float, float], ...]) -> None:
    for point in points:
        frame = model.ground.frame
        assert frame is not None
        assert model.home is not None
        model.ground.cursor = frame.to_place((model.home[0] + point[0], model.home[1] + point[1]))
        await pilot.press("a")


async def _upload(pilot: Pilot[int], model: MapModel, wait: Wait) -> None:
    await pilot.press("U", "y")
    await wait(lambda: not model.editor.edited)
