"""The Parameters screen with a real station and three kinds of vehicles: edit, refuse, undo, compare, save."""

from __future__ import annotations

import contextlib
import json
from collections.abc import AsyncIterator, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from textual.pilot import Pilot

from groundstation.client import StationClient
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.params.model import ParamModel
from tests.fakes.params import Param, many_params
from tests.fakes.services import ARDUPILOT, PX4, foreign_vehicle
from tests.groundstation.ui import frames
from tests.waits import until

pytestmark = pytest.mark.usefixtures("stock_pilot")

DOCS = {
    "parameters": [
        {"name": "FS_ACTION", "shortDesc": "Failsafe Action", "values": [{"value": 1, "description": "RTL"}]},
    ]
}


@dataclass(frozen=True)
class Kind:
    """A vehicle, a parameter with a name of its list that is typed, its values, and one that the vehicle refuses."""

    autopilot: int | None
    name: str
    typed: str
    before: float
    after: float
    fixed: str
    words: str


OURS = Kind(None, "FS_GCS_ENABLE", "no action", 1.0, 0.0, "ACRO_TURN_RATE", "not tried: FS_GCS_ENABLE")
FOREIGN = ("FS_ACTION", "rtl", 2.0, 1.0, "STAT_BOOTCNT",
           "kept by the vehicle: STAT_BOOTCNT (1 of 2 set) · set: FS_ACTION")  # fmt: skip


@dataclass(frozen=True)
class Live:
    """The app at work. What it shows is read from the model: a frame is expensive."""

    app: ConsoleApp
    pilot: Pilot[int]

    @property
    def model(self) -> ParamModel:
        found: ParamModel = self.app.drive.context.kept[ParamModel]
        return found

    @property
    def values(self) -> dict[str, float]:
        """The pending values."""
        return {name: change.value for name, change in self.model.pending.items()}

    async def type(self, text: str) -> None:
        """Paste a text into the field and end it: a key for each letter takes long."""
        screen = self.app.screen
        assert isinstance(screen, ConsoleScreen)
        screen.field.value = text
        await self.pilot.press("enter")

    async def find(self, name: str) -> None:
        """Select a parameter by its name, and wait for its texts."""
        await self.pilot.press("slash")
        await self.type(name)
        await self.pilot.press("home")
        await until(lambda: (row := self.model.selected) is not None and row.name == name and name in self.model.infos)

    async def change(self, text: str) -> None:
        """Type a value for the selected parameter."""
        await self.pilot.press("enter")
        await self.type(text)

    async def write(self, words: str) -> None:
        """Write the changes and wait for how that ends."""
        await self.pilot.press("W", "y")
        await until(lambda: words in self.model.last_write)

    async def compare(self, name: str) -> None:
        """Open a file and wait for the comparison."""
        await self.pilot.press("O")
        await self.type(name)
        await until(lambda: self.model.diff is not None and self.model.diff.file == name)


@contextlib.contextmanager
def station(kind: Kind, folder: Path) -> Iterator[StationClient]:
    """A station with one vehicle."""
    with contextlib.ExitStack() as stack:
        endpoints = []
        if kind.autopilot is not None:
            vehicle = stack.enter_context(foreign_vehicle(kind.autopilot))
            vehicle.params["FS_ACTION"] = Param(2, 2, 1)
            vehicle.params["STAT_BOOTCNT"] = Param(7, 4, read_only=True)
            vehicle.params |= dict(many_params(300))
            endpoints = [vehicle.endpoint]
        docs = folder / "parameters.json"
        docs.write_text(json.dumps(DOCS))
        client = StationClient.start(endpoints, sitl=not endpoints, param_docs=docs)
        stack.callback(client.close)
        yield client


@contextlib.asynccontextmanager
async def live(kind: Kind, folder: Path) -> AsyncIterator[Live]:
    with station(kind, folder) as client:
        app = ConsoleApp(client, Keymap("standard", KEYMAPS["standard"]), folder=folder)
        async with app.run_test(size=(140, 45)) as pilot:
            await until(lambda: app.drive.snapshot.vehicle is not None)
            await pilot.press("f4")
            yield Live(app, pilot)


@pytest.mark.parametrize(
    "kind", [OURS, Kind(ARDUPILOT, *FOREIGN), Kind(PX4, *FOREIGN)], ids=["mavhelm", "ardupilot", "px4"]
)
async def test_edit_refuse_undo_save_and_compare(kind: Kind, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    async with live(kind, tmp_path) as at:
        await at.find(kind.name)
        await until(lambda: at.model.infos[kind.name].values)
        await at.change(kind.typed)
        assert at.values == {kind.name: kind.after}
        await at.write("1 of 1 confirmed")
        await until(lambda: at.model.infos[kind.name].value == kind.after)

        await at.pilot.press("u")
        assert at.values == {kind.name: kind.before}
        await at.find(kind.fixed)
        await at.change("3")
        await at.write(kind.words)
        assert at.model.last_write.startswith("refused: ")
        await until(lambda: "refused: " in frames.text(at.app))
        await at.pilot.press("x")

        await at.find(kind.name)
        written = kind.after if kind.autopilot is None else kind.before  # ours stopped at the refusal
        await until(lambda: at.model.infos[kind.name].value == written)  # shown a moment after it was confirmed
        now = at.model.infos[kind.name].value
        other = kind.after if now == kind.before else kind.before
        await at.pilot.press("S")
        await at.type("a.param")
        await until((tmp_path / "a.param").exists)
        saved = (tmp_path / "a.param").read_text()
        assert f"{kind.name:<16} {now:f}\n" in saved
        (tmp_path / "b.param").write_text(saved.replace(f"{kind.name:<16} {now:f}", f"{kind.name},{other}"))
        await at.compare("b.param")
        assert at.model.diff is not None
        assert (at.model.diff.different, at.model.diff.only_file) == (((kind.name, now, other),), ())
        await at.pilot.press("a")
        assert at.values == {kind.name: other}
        await at.write("1 of 1 confirmed")
        await until(lambda: at.model.diff is not None and not at.model.diff.different)
