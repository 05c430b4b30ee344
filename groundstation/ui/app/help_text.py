"""Text of the help: sections of keys and what they do, those that match a filter, in columns.

Knows neither Textual nor the size of a terminal: the width is an argument.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from groundstation.actions import ACTIONS
from groundstation.input.keymap import Keymap
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.display.display_state import ScreenKey
from groundstation.ui.display.wrap import wrap
from groundstation.ui.keys.keynames import format_key
from groundstation.ui.look.colours import BLUE, DIM, RED, TEXT, YELLOW

TITLES = {
    "drive": "Drive", "stop": "Stop", "speed": "Speed limits", "view": "Pane of the Drive screen",
    "vehicle": "Vehicle", "app": "Ground station",
}  # fmt: skip
"""Group of actions -> its heading, in this order."""

COMMON = ("stop", "app")
"""Groups that work on every screen: they follow the keys of the screen itself."""

STATUS_LINE = (
    ("link", "bars for loss: 4 up to 2 %, 3 up to 10 %, 2 up to 25 %, then 1"),
    ("loss", "frames of the vehicle lost over the last 5 s"),
    ("rtt", "round trip to the vehicle and back (TIMESYNC)"),
    ("sent", "MANUAL_CONTROL frames sent per second"),
    ("cmd", "age of the newest demand that the vehicle has taken; from 450 ms on our vehicle stops"),
    ("key→motor", "time from a changed demand to the vehicle that applies it"),
    ("tty", "round trip to this terminal; without answers keys do not drive"),
    ("pre-arm", "the vehicle's checks before arming; the log has the reasons"),
    ("gps, batt", "GPS fix and satellites; battery voltage and charge"),
)
"""Readings of the status line, in its order, and their meaning."""

LIST_KEYS = (
    ("↑ ↓", "Move in the list or panel with the blue frame"),
    ("PgUp  PgDn", "Move by a page; also ^b ^f, half a page ^u ^d"),
    ("HOME  END", "First and last row; also g and G, but for Map and Links, where they are commands"),
    ("y", "Copy what is under the cursor"),
    ("TAB", "Next panel, where a screen has several"),
    ("ESC", "Close what is open, then go back to Drive"),
)
"""Keys that all screens but Drive have in common."""

NOTES = (
    "Any key without a drive action stops the vehicle while it is driven, but for the speed keys, v, PgUp and PgDn.",
    "The emergency stop works on every screen.",
    "Keys drive only on the Drive screen and while this window has the focus; leaving either stops the vehicle.",
    "Back on Drive, without key releases: a drive key counts once none was pressed or repeated for 0.75 s.",
    "In a text field SPACE and k are text: ^k stops there, and ! is the emergency stop as everywhere.",
    "The limits are the largest demand that a key sends: speed and turn, in percent of the full range.",
    "Where the terminal reports key releases, keys of a Cyrillic or Greek layout count by their position.",
    "The mouse does nothing on Drive. Elsewhere a click chooses a tab, a row or a key of the footer, the wheel moves.",
    "It presses no key that stops or reaches a vehicle. Shift and drag selects text.",
)

WIDE, VERY_WIDE = 112, 170
"""Columns of text from which on the sections stand in two columns, and in three."""

GAP = 3
"""Cells between two columns of sections."""

_MIN_KEYS, _MAX_KEYS = 6, 24
"""Cells of the column of keys; a key map or a gamepad adds longer ones."""

Part = tuple[str, str]
"""A text and its colour."""

Line = tuple[Part, ...]


class HelpRow(msgspec.Struct, frozen=True):
    """A key and what it does; a note has no key."""

    key: str
    text: str
    colour: str = YELLOW


class HelpSection(msgspec.Struct, frozen=True):
    """Rows below a heading."""

    title: str
    rows: tuple[HelpRow, ...]

    def matching(self, text: str) -> HelpSection:
        """Return the section with the rows that contain each word; all rows if the heading does."""
        words = text.lower().split()
        found = (row for row in self.rows if _contains(f"{self.title} {row.key} {row.text}", words))
        return HelpSection(self.title, tuple(found))


def build_sections(keymap: Keymap, own: ScreenRow, screen_keys: dict[str, tuple[ScreenKey, ...]]) -> list[HelpSection]:
    """Return the sections: the screen `own` first, then what works everywhere, then the rest.

    `screen_keys` are the keys of each screen by its id.
    """
    groups = {name: HelpSection(title, tuple(_action_rows(keymap, name))) for name, title in TITLES.items()}
    drives = own is SCREENS[0]
    first = [name for name in TITLES if drives or name in COMMON]
    rest = [name for name in TITLES if name not in first]
    lists = HelpSection("Lists and panels", tuple(HelpRow(*each) for each in LIST_KEYS))
    sections = [
        *([] if drives else [_screen_section(own, screen_keys), lists]),
        *(groups[name] for name in (*first, *rest)),
        *([lists] if drives else []),
        *(_screen_section(row, screen_keys) for row in SCREENS if row is not own),
        HelpSection("Status line", tuple(HelpRow(*each) for each in STATUS_LINE)),
        HelpSection("Notes", tuple(HelpRow("", note, DIM) for note in NOTES)),
    ]
    return [each for each in sections if each.rows]


def lay_out(sections: Iterable[HelpSection], width: int) -> list[Line]:
    """Return the lines of all sections, the rows of each in one, two or three columns below its heading."""
    count = 1 if width < WIDE else 2 if width < VERY_WIDE else 3
    each = (width - GAP * (count - 1)) // count
    lines: list[Line] = []
    for section in sections:
        columns = _share(_draw_rows(section, each), count)
        height = max(map(len, columns))
        lines.append(((section.title, f"bold {BLUE}"),))
        lines += (_join([part[at] if at < len(part) else () for part in columns], each) for at in range(height))
        lines.append(())
    return lines


def _share(rows: Sequence[list[Line]], count: int) -> list[list[Line]]:
    """Return rows in columns of about the same height, in their order from top to bottom; no row is cut in two."""
    total = sum(map(len, rows))
    columns: list[list[Line]] = [[] for _ in range(count)]
    done = 0
    for row in rows:
        columns[min(count - 1, done * count // max(1, total))] += row
        done += len(row)
    return columns


def _join(parts: Sequence[Line], width: int) -> Line:
    joined: list[Part] = []
    for at, line in enumerate(parts):
        joined += line
        if at + 1 < len(parts):
            joined.append((" " * (width + GAP - sum(len(text) for text, _ in line)), TEXT))
    return tuple(joined)


def _draw_rows(section: HelpSection, width: int) -> list[list[Line]]:
    """Return the lines of each row: its text is wrapped beside the key."""
    keys = max(_MIN_KEYS, min(_MAX_KEYS, max((len(row.key) for row in section.rows), default=0))) + 2
    return [_draw_row(row, keys + 2 if row.key else 2, width) for row in section.rows]


def _draw_row(row: HelpRow, begin: int, width: int) -> list[Line]:
    lines: list[Line] = []
    for number, text in enumerate(wrap(row.text, max(10, width - begin))):
        key = " " * begin if number else f"  {row.key}".ljust(begin)
        lines.append(((key, row.colour), (text, "" if row.key else row.colour)))
    return lines


def _action_rows(keymap: Keymap, group: str) -> Iterable[HelpRow]:
    for action in ACTIONS.values():
        keys = keymap.get_keys(action.id)
        if action.group == group and keys:
            names = "  ".join(format_key(key) for key in keys)
            yield HelpRow(f"hold {names}" if action.confirm else names, action.help, RED if group == "stop" else YELLOW)


def _screen_section(row: ScreenRow, screen_keys: dict[str, tuple[ScreenKey, ...]]) -> HelpSection:
    keys = screen_keys.get(row.id, ())
    return HelpSection(f"{row.title} screen", tuple(HelpRow(format_key(each.key), each.help) for each in keys))


def _contains(text: str, words: Iterable[str]) -> bool:
    shown = text.lower()
    return all(word in shown for word in words)
