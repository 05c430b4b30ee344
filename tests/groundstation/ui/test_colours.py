"""Everything on the Drive screen can be read with 256 and with 16 colours, too."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import pytest
from rich.color import Color, ColorSystem
from rich.segment import Segment

from groundstation.actions import ACTIONS
from groundstation.input.hold_to_confirm import HoldProgress
from groundstation.snapshot import Snapshot
from groundstation.ui.colours import FAINT, GROUND, MUTED, badge
from groundstation.ui.display_state import DisplayState
from groundstation.ui.instruments import INSTRUMENTS
from groundstation.ui.key_gate import GateClosure
from tests.groundstation.ui.examples import helm, snapshot, vehicle, waiting
from tests.groundstation.ui.ptys import STANDARD

PICTURES = {
    "driving": snapshot(),
    "disarmed": snapshot(vehicle=vehicle(armed=False), operator=helm(gate_open=False)),
    "emergency stop": snapshot(vehicle=vehicle(emergency_stop=True)),
    "no heartbeat": snapshot(vehicle=vehicle(alive=False)),
    "foreign": snapshot(vehicle=vehicle(in_control=False, driver=254, mode="AUTO")),
    "latched": snapshot(operator=helm(style="latch")),
    "waiting": waiting(),
}
SYSTEMS = {"256": ColorSystem.EIGHT_BIT, "16": ColorSystem.STANDARD}


def segments(picture: Snapshot) -> Iterator[Segment]:
    closures = (None, GateClosure("this window does not have the focus"))
    for closure, hold in product(closures, (None, HoldProgress(ACTIONS["vehicle.arm"], "r", 0.4))):
        state = DisplayState(picture, STANDARD, closure=closure, hold=hold)
        for row in INSTRUMENTS:
            for line in row.build(row.value(state), id=row.id).draw(80, 5):
                yield from line


@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
@pytest.mark.parametrize("picture", PICTURES.values(), ids=PICTURES)
def test_no_text_has_the_colour_of_its_background(picture: Snapshot, system: ColorSystem) -> None:
    seen = 0
    for segment in segments(picture):
        look = segment.style
        if segment.text.strip() and look is not None and look.color is not None and look.bgcolor is not None:
            seen += 1
            ink, ground = look.color.downgrade(system), look.bgcolor.downgrade(system)
            assert ink.number != ground.number, segment
    assert seen > 20


@pytest.mark.parametrize("colour", [FAINT, MUTED])
def test_greys_stay_grey_with_256_colours(colour: str) -> None:
    red, green, blue = Color.parse(colour).downgrade(ColorSystem.EIGHT_BIT).get_truecolor()
    assert red == green == blue


def test_ground_stays_brown_with_256_colours() -> None:
    assert Color.parse(GROUND).downgrade(ColorSystem.EIGHT_BIT).get_truecolor().hex == "#875f00"


def test_dark_text_on_a_badge_is_not_bold() -> None:
    """Terminals with 16 colours draw bold black as grey."""
    assert not badge("#ffd75f").bold
