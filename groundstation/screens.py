"""SCREENS: every screen of the ground station, its keys and its class. A new screen is its module and one row here."""

from __future__ import annotations

import msgspec


class ScreenRow(msgspec.Struct, frozen=True):
    """One screen. It has the action `app.<id>` in ACTIONS, so that a key map file can bind other keys to it."""

    id: str
    title: str
    """One or two words for the footer and the palette."""
    help: str
    keys: tuple[str, ...]
    """Default keys that open it, in every key map."""
    digit: str
    """Its key in the go-to menu. Screens without one ("") are not in the tab bar."""
    target: str
    """"module:Class" of a ConsoleScreen. Loaded when first opened: the program starts sooner, and this table stays free
    of Textual."""
    short: str = ""
    """Title where the tab bar is narrow; empty: `title`."""

    @property
    def action(self) -> str:
        """Id of the action that opens it."""
        return f"app.{self.id}"

    @property
    def in_tabs(self) -> bool:
        """The tab bar and the go-to menu list it."""
        return bool(self.digit)


SCREENS: tuple[ScreenRow, ...] = (
    ScreenRow("drive", "Drive", "Drive screen, the only one where keys drive", ("f1",), "1",
              "groundstation.ui.drive.screen:DriveScreen"),
    ScreenRow("map", "Map", "Mission, fence and rally points: edit, upload, drive them", ("f2",), "2",
              "groundstation.ui.map.screen:MapScreen"),
    ScreenRow("messages", "Messages", "Every message with its rate, and the fields of one", ("f3",), "3",
              "groundstation.ui.messages.screen:MessagesScreen", "Msg"),
    ScreenRow("params", "Params", "Parameters of the vehicle: read, change, write", ("f4",), "4",
              "groundstation.ui.params.screen:ParamsScreen", "Par"),
    ScreenRow("charts", "Charts", "Fields of messages over time, with modes, events and own keys", ("f5",), "5",
              "groundstation.ui.charts.screen:ChartsScreen", "Chart"),
    ScreenRow("log", "Log", "All alerts and messages, to scroll, filter and save", ("f6",), "6",
              "groundstation.ui.log.screen:LogScreen"),
    ScreenRow("links", "Links", "Vehicles, links and who is in control: choose a vehicle", ("f7",), "7",
              "groundstation.ui.links.screen:LinksScreen", "Link"),
    ScreenRow("setup", "Setup", "Why the vehicle cannot be driven, motor test, calibration", ("f8",), "8",
              "groundstation.ui.setup.screen:SetupScreen"),
    ScreenRow("files", "Files", "Logs and files of the vehicle: download, upload, delete", (), "9",
              "groundstation.ui.files.screen:FilesScreen", "File"),
    ScreenRow("replay", "Replay", "A telemetry log: timeline, events, search; every screen shows its moment", (), "0",
              "groundstation.ui.replay.screen:ReplayScreen", "Play"),
    ScreenRow("connect", "Connect", "What can be connected to: vehicles heard, endpoints, ports", (), "c",
              "groundstation.ui.connect.screen:ConnectScreen", "Conn"),
    ScreenRow("help", "Help", "Keys and what they do", ("question_mark",), "",
              "groundstation.ui.app.help:HelpScreen"),
)  # fmt: skip
"""In the order of the tab bar and of the help screen. The first one is at the bottom of the screen stack: Escape leads
back to it."""


def find_screen(target: str) -> ScreenRow | None:
    """Return the row of a class, "module:Class"."""
    return next((row for row in SCREENS if row.target == target), None)
