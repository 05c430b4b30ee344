"""PlanMap: mission, fence, rally points, vehicles and the cursor on the ground. North is up. Takes no keys."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.look.colours import BLUE, DIM, style
from groundstation.ui.map.draw.plan_drawing import LEGS, PlanDrawing
from groundstation.ui.map.draw.plan_map_value import PlanMapValue
from groundstation.ui.map.draw.window import fit_window
from groundstation.ui.widgets.canvas import Canvas, draw_obstacles
from groundstation.ui.widgets.instrument import Instrument


class PlanMap(Instrument[PlanMapValue]):
    """The map. Drive shows it as a pane, the Map screen with a cursor."""

    BORDER_TITLE = "map"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw what matters least first: rings, layers, fence, track, legs, cursor, labels, vehicle."""
        canvas, value = Canvas(width, height), self.value
        if value.note:
            canvas.write(max(0, (width - len(value.note)) // 2), height // 2, value.note, style(DIM))
            return canvas.strips()
        window = value.window or fit_window(value.points, canvas.across, canvas.down)
        drawing = PlanDrawing(canvas, window)
        drawing.rings(value.home or value.vehicle or (0.0, 0.0))
        drawing.layers(value.layers)
        for outline in value.outlines:
            drawing.outline(outline)
        drawing.path(value.track, style(BLUE))
        for leg in value.legs:
            colour, dots, gap = LEGS[leg.look]
            drawing.dashes(leg.start, leg.end, style(colour), dots, gap)
        draw_obstacles(canvas, map(drawing.at, value.obstacles))
        drawing.cross(value.cursor, value.measured)
        drawing.labels(value)
        drawing.vehicle(value)
        drawing.frame(value)
        return canvas.strips()
