"""Control panel of the Links screen: who is in control of the selected vehicle, who else is there, and signing."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from textual.strip import Strip

from groundstation.snapshot.signing import SigningState
from groundstation.ui.links.vehicle_table import age_text
from groundstation.ui.look.colours import AMBER, DIM, GREEN, RED, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, Part, cropped, strip
from groundstation.views.links import ControlView, Program

OLD_REPORT = 3.0
"""s since the vehicle reported who is in control from which on the age is shown: it reports once a second."""


class ControlPanelValue(msgspec.Struct, frozen=True):
    """The view, and the keys that its lines name."""

    view: ControlView | None = None
    """None until the first one has arrived."""
    request_key: str = "?"
    release_key: str = "?"
    top: int = 0
    """First line that is shown."""


class ControlPanel(Instrument[ControlPanelValue]):
    """One fact per line, the most important first."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines from `top` on, cut at the right edge."""
        return [cropped(strip(*line), width) for line in self._lines()[self.value.top :][:height]]

    @property
    def wanted(self) -> int:
        """Lines that everything needs."""
        return len(self._lines())

    def _lines(self) -> list[list[Part]]:
        view = self.value.view
        if view is None:
            return [[(" waiting for the station", style(DIM))]]
        if not view.vehicle:
            return [[(" no vehicle yet", style(DIM))], *map(_fact, (*_signing(view), *_others(view)))]
        return [self._driver(view), *_warnings(view), *map(_fact, (*_takeover(view), *_signing(view), *_others(view)))]

    def _driver(self, view: ControlView) -> list[Part]:
        parts = [(f" {'in control':<12}", style(DIM)), *self._who(view)]
        if view.age is not None and view.age >= OLD_REPORT:
            parts.append((f" · reported {age_text(view.age)} ago", style(AMBER)))
        return parts

    def _who(self, view: ControlView) -> list[Part]:
        request, release = self.value.request_key, self.value.release_key
        if view.driver is None:
            ours = (
                f"it accepts our commands · {release} releases control" if view.in_control else f"{request} requests it"
            )
            return [("this vehicle does not tell", style(AMBER)), (f" · {ours}", style(DIM))]
        if not view.driver:
            return [("no ground station", style(TEXT)), (f" · {request} requests control", style(DIM))]
        driver = view.program or Program(view.driver, 0)
        if view.driver == view.ours.system:
            return _own(view, driver, release)
        return [(f"ground station {_name(driver)}", style(AMBER, bold=True)), (f" · {request} asks for it", style(DIM))]


def _own(view: ControlView, driver: Program, release: str) -> list[Part]:
    """Return who has our system id: this program, or another one with the same id."""
    ours = view.ours
    same = driver.component in (0, ours.component) and driver.session in (0, ours.session)
    if same and view.in_control:
        return [(f"this one, {_name(driver)}", style(GREEN, bold=True)), (f" · {release} releases it", style(DIM))]
    text = f"another program with our id: {_name(driver)}" if not same else f"our id, {_name(driver)}"
    return [(text, style(RED, bold=True)), (" · use another --system", style(DIM))]


def _name(program: Program) -> str:
    """Return system and component id, and the session where it is known."""
    ids = f"{program.system}/{program.component}" if program.component else str(program.system)
    return f"{ids}, session {program.session:08x}" if program.session else ids


def _warnings(view: ControlView) -> Iterator[list[Part]]:
    if view.clash:
        yield [
            (f" {'!':<12}two programs send with the ids of the driver: its demands do not count", style(RED, bold=True))
        ]
    if view.silent and view.driver:
        yield [(f" {'!':<12}the driver is silent: another program with its ids may succeed it", style(AMBER))]
    if view.waits is not None:
        yield [(f" {'asked':<12}the driver may answer for {view.waits:.0f} s", style(AMBER))]


def _fact(fact: tuple[str, str, str]) -> list[Part]:
    name, text, colour = fact
    return [(f" {name:<12}", style(DIM)), (text, style(colour))]


def _takeover(view: ControlView) -> Iterator[tuple[str, str, str]]:
    if view.driver is not None:
        text = "granted without asking the driver" if view.takeover else "only if the driver agrees"
        yield "takeover", text, AMBER if view.takeover else TEXT


def _signing(view: ControlView) -> Iterator[tuple[str, str, str]]:
    """Yield the state, what was refused beside it, how the clocks differ, and who signs if the vehicle does not."""
    known = view.signing
    if known is None:
        yield "signing", "no vehicle signs, and no frame was refused", DIM
        return
    yield "signing", known.text, TEXT if known.well or known.state is SigningState.ON else AMBER
    if known.refused and known.state is SigningState.ON:
        yield "refused", f"{known.refused} with its id in 5 s: they are somebody else's, or copies", AMBER
    if known.clock:
        yield "clock", known.clock, TEXT
    if known.state is SigningState.OFF and view.signing_systems:
        yield "", f"systems that sign: {', '.join(map(str, view.signing_systems))}", TEXT


def _others(view: ControlView) -> Iterator[tuple[str, str, str]]:
    heard = [f"{each.system}/{each.component} {age_text(each.silence)} ago" for each in view.stations]
    yield "also heard", " · ".join(heard) or "no other ground station", TEXT if heard else DIM
