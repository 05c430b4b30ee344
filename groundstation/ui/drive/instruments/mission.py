"""Mission strip: the legs to scale, done, now and to go, and the next item with its distance and time."""

from __future__ import annotations

import math

import msgspec
from textual.strip import Strip

from groundstation.snapshot import VehicleView
from groundstation.snapshot.drive import MissionProgress
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, LINE, TEXT, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, finite_or_none, length, strip

ROOMY = 60
"""Cells from which on the number of the last item is shown."""

FAR = 9999.5
"""m from which on distances are in km."""


NEAR = 1.0
"""m from home within which its direction says nothing."""


class FlightFigures(msgspec.Struct, frozen=True):
    """What a pilot looks at beside the altitude, rounded to what is drawn."""

    speed: float | None
    climb: float | None
    bearing: int | None
    """Direction home, degrees."""
    battery: float | None
    """s left at the rate of the last minutes."""

    @classmethod
    def from_vehicle(cls, vehicle: VehicleView) -> FlightFigures:
        """Return the figures of a vehicle that flies."""
        bearing = None
        if vehicle.home is not None and vehicle.position is not None:
            north, east = (home - here for home, here in zip(vehicle.home, vehicle.position, strict=True))
            if math.hypot(north, east) >= NEAR:
                bearing = round(math.degrees(math.atan2(east, north))) % 360
        speed, climb = finite_or_none(vehicle.speed_over_ground), finite_or_none(vehicle.climb)
        return cls(
            None if speed is None else round(speed, 1),
            None if climb is None else round(climb, 1) + 0.0,
            bearing,
            None if vehicle.battery_left is None else round(vehicle.battery_left / 60),
        )


class MissionValue(msgspec.Struct, frozen=True):
    """The mission, with figures rounded to what is drawn."""

    mission: MissionProgress | None = None
    home: float | None = None
    """Distance from home, m."""
    flight: FlightFigures | None = None
    """Of what flies."""

    @classmethod
    def from_vehicle(cls, vehicle: VehicleView | None) -> MissionValue:
        """Return the strip of a vehicle."""
        if vehicle is None:
            return cls()
        home = None
        if vehicle.home is not None and vehicle.position is not None:
            home = math.dist(vehicle.home, vehicle.position)
        rounded = None if home is None or not math.isfinite(home) else round(home, 1)
        flight = FlightFigures.from_vehicle(vehicle) if vehicle.flies else None
        return cls(_rounded(vehicle.mission) if vehicle.mission else None, rounded, flight)


def _flight_parts(flight: FlightFigures, home: list[list[Part]], *, whole: bool) -> list[list[Part]]:
    """Return climb, speed, the way home and the battery, the most important first. `whole`: with their names."""
    speed = "-.-" if flight.speed is None else f"{flight.speed:.1f}"
    climb = "-.-" if flight.climb is None else f"{flight.climb:+.1f}"
    names = (" climb ", " m/s", "  speed ") if whole else (" up ", "", " ")
    parts: list[list[Part]] = [
        [(names[0], style(DIM)), (f"{climb}{names[1]}", style(TEXT, bold=True))],
        [(names[2], style(DIM)), (f"{speed} m/s", style(TEXT))],
        *home,
    ]
    if home and flight.bearing is not None:
        parts[-1] = [*parts[-1], (f" {flight.bearing:03d}°", style(TEXT))]
    if flight.battery is not None:
        parts.append([("  battery ", style(DIM)), (f"{flight.battery:.0f} min", style(TEXT))])
    return parts


def _rounded(mission: MissionProgress) -> MissionProgress:
    def to(value: float | None, digits: int) -> float | None:
        return None if value is None or not math.isfinite(value) else round(value, digits)

    return MissionProgress(
        current=mission.current, last=mission.last, command=mission.command, distance=to(mission.distance, 1),
        legs=mission.legs, places=mission.places, left=to(mission.left, 0), time_left=to(mission.time_left, 0),
    )  # fmt: skip


class MissionStrip(Instrument[MissionValue]):
    """Two lines: the legs, and figures; the figures alone where there is one."""

    BORDER_TITLE = "mission"

    def show(self, value: MissionValue) -> None:
        """Show another value, and what it is of in the title."""
        super().show(value)
        flies = value.flight is not None and value.mission is None
        # Textual paints the whole frame again, also for the same title.
        if flies and self.border_title != "flight":
            self.border_title = "flight"
        elif not flies and self.border_title != "mission":
            self.border_title = "mission"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw what is known; figures that do not fit are left out from the end."""
        figures = strip(*_fitting(self._figures(whole=width >= ROOMY), width)).crop(0, width)
        mission = self.value.mission
        if height < 2 or mission is None or not mission.legs:
            return [figures]
        return [_legs(mission, width).crop(0, width), figures]

    def _figures(self, *, whole: bool) -> list[list[Part]]:
        mission, home = self.value.mission, self.value.home
        away: list[list[Part]] = [] if home is None else [[("  home ", style(DIM)), (metres(home), style(TEXT))]]
        if self.value.flight is not None:
            away = _flight_parts(self.value.flight, away, whole=whole)
            if mission is None:
                return away
        if mission is None:
            return [[(" no mission", style(DIM))], *away]
        of = "" if mission.last is None or not whole else f" of {mission.last}"
        item: list[Part] = [(" item ", style(DIM)), (f"{mission.current}", style(YELLOW, bold=True)), (of, style(DIM))]
        item += [(f" {mission.command}", style(YELLOW))] if mission.command else []
        if mission.distance is not None:
            item += [(" in ", style(DIM)), (metres(mission.distance), style(TEXT))]
        left: list[Part] = []
        if mission.left is not None:
            left = [("  left ", style(DIM)), (metres(mission.left), style(TEXT))]
            left += [] if mission.time_left is None else [(f", {_minutes(mission.time_left)}", style(TEXT))]
        return [item, left, *away]


def _legs(mission: MissionProgress, width: int) -> Strip:
    """Return the legs to scale: done, the one that is driven, to go; a number where each of them ends."""
    whole = sum(mission.legs) or 1.0
    room = max(1, width - 2)
    ends, at = [], 0.0
    for leg in mission.legs:
        at += leg
        ends.append(round(at / whole * room))
    now = next((index for index, number in enumerate(mission.places) if number >= mission.current), len(ends))
    cells: list[Part] = [_leg_cell(column, ends, now, mission, room) for column in range(room + 1)]
    for number, end in zip(mission.places, ends, strict=False):
        colour = GREEN if number < mission.current else YELLOW if number == mission.current else BLUE
        for offset, digit in enumerate(str(number)):
            if 0 <= end - len(str(number)) + 1 + offset < len(cells):
                cells[end - len(str(number)) + 1 + offset] = (digit, style(colour, bold=True))
    return strip(("⌂", style(AMBER)), *_joined(cells))


def _leg_cell(column: int, ends: list[int], now: int, mission: MissionProgress, room: int) -> Part:
    start, end = ends[now - 1] if 0 < now <= len(ends) else 0, ends[now] if now < len(ends) else room + 1
    if column < start or now >= len(ends):
        return "━", style(GREEN)
    if column >= end:
        return "─", style(LINE)
    leg = mission.legs[now]
    share = 0.0 if mission.distance is None or leg <= 0 else max(0.0, min(1.0, 1.0 - mission.distance / leg))
    reached = start + round(share * (end - start))
    if column < reached:
        return "━", style(GREEN)
    return ("▶" if column == reached else "━"), style(YELLOW)


def _joined(cells: list[Part]) -> list[Part]:
    """Return runs of one style as one part each."""
    runs: list[Part] = []
    for text, look in cells:
        if runs and runs[-1][1] is look:
            runs[-1] = (runs[-1][0] + text, look)
        else:
            runs.append((text, look))
    return runs


def _fitting(groups: list[list[Part]], width: int) -> list[Part]:
    parts: list[Part] = []
    for group in groups:
        if parts and length(parts) + length(group) > width:
            break
        parts += group
    return parts


def metres(distance: float) -> str:
    """Return a distance: "14.9 m", "135 m", "12 km"."""
    if distance < 99.95:
        return f"{distance:.1f} m"
    return f"{distance:.0f} m" if distance < FAR else f"{distance / 1000:.0f} km"


def _minutes(seconds: float) -> str:
    return f"{seconds // 60:.0f}:{seconds % 60:02.0f}" if seconds < 6000 else f"{seconds / 3600:.0f} h"
