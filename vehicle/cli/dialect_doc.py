"""docs/dialect.md, built from the tables in the code. `mavhelm vehicle dialect` prints it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import zip_longest

from dialects import messages as m
from dialects.definition import MessageDefinition, private_enums, private_messages
from dialects.enums import FenceItem, command_name
from dialects.traits import LOG_ONLY
from vehicle.autonomy.mission.rules import FENCE_RULES, MISSION_RULES, RALLY_RULES
from vehicle.commands.access import Access
from vehicle.commands.buttons import FUNCTIONS
from vehicle.commands.context import COMPONENT
from vehicle.modes import MODES, PX4_ALIASES
from vehicle.params import TABLE, Params
from vehicle.rover import Rover
from vehicle.telemetry.streams import STREAMS, DialectLevel

TO_WHOM = {
    DialectLevel.COMMON: "",
    DialectLevel.NEWER: "peers that request newer messages",
    DialectLevel.ROVER: "peers that request ROVER_*",
}
"""Receivers of a stream; empty for all peers."""

CELL = 120
"""Characters of a cell of a table, so that an editor shows it."""

FENCE_NOTE = "RETURN_POINT, at most one, is only stored: the rover never drives there, FENCE_ACTION decides"

HEAD = f"""\
# The MAVLink dialect of the vehicle

Printed by `mavhelm vehicle dialect > docs/dialect.md` from the tables in the code; a test compares the two.

MAVLink 2 (version 1 is understood), component {COMPONENT} (autopilot), type ground rover, autopilot generic. The
message set is pymavlink's common.xml with `dialects/rover.xml`. Who may send a message or a command:

- **{Access.ANYONE.value}**: every system.
- **{Access.CONNECTED.value}**: a system that has sent a HEARTBEAT or connected (TCP), or whose address the user named.
- **{Access.INTRODUCED.value}**: a system that has sent a HEARTBEAT.
- **{Access.DRIVER_OR_UNCLAIMED.value}**: the ground station in control, or any introduced one while none is in control.
- **{Access.DRIVER.value}**: the ground station in control.
"""


def build_document() -> str:
    """Build the whole document."""
    rover = Rover(Params(), now=0.0)
    return "\n".join(
        (
            HEAD,
            _section("Streams", _streams()),
            _section("Messages that are handled", _messages(rover)),
            _section("Commands", _commands(rover)),
            _section("Plan items", _items(rover)),
            _section("Modes", _modes()),
            _section("Buttons of MANUAL_CONTROL", _buttons()),
            _section("Parameters", _parameters()),
            _private(rover),
        )
    )


def _section(title: str, text: str) -> str:
    return f"## {title}\n\n{text}"


def _table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    lines = [head, ["---"] * len(head), *(line for row in rows for line in _lines(row))]
    return "".join(f"| {' | '.join(str(cell).replace('|', chr(92) + '|') for cell in row)} |\n" for row in lines)


def _lines(row: Sequence[object]) -> Iterable[tuple[str, ...]]:
    """Return the lines of a row: a long cell goes on in further lines, whose other cells are empty."""
    return zip_longest(*(_pieces(str(cell)) for cell in row), fillvalue="")


def _pieces(text: str) -> list[str]:
    """Split a text into pieces of at most CELL characters, behind its punctuation where it has any."""
    pieces = []
    while len(text) > CELL and " " in text[:CELL]:
        cut = max(text.rfind(f"{mark} ", 0, CELL) for mark in ".;:,") + 1 or text.rfind(" ", 0, CELL)
        pieces.append(text[:cut])
        text = text[cut + 1 :]
    return [*pieces, text]


def _streams() -> str:
    rows = [
        (stream.message.msgname, stream.message.id, f"{stream.rate:g}" if stream.rate else "on request",
         "and on change" if stream.change_key else "", TO_WHOM[stream.level], stream.group.name if stream.group else "")
        for stream in STREAMS
    ]  # fmt: skip
    more = (
        "Rates are defaults, separate for each ground station: SET_MESSAGE_INTERVAL and REQUEST_DATA_STREAM change\n"
        "them for their sender; slow links and full radio buffers lower them.\n\n"
        "A peer that has requested one of the newer messages (or AVAILABLE_MODES, COMPONENT_METADATA, control, a\n"
        "standard mode) gets all of those. A peer that has requested a ROVER_* message, or sent\n"
        "ROVER_OPERATOR_PRESENCE, gets those too. Other peers would count them as lost. ROVER_LINK_STATUS is\n"
        "sent once a second for each link to peers that get ROVER_*. All other messages are answers.\n"
    )
    return f"{_table(('message', 'id', 'Hz', '', 'to whom', 'REQUEST_DATA_STREAM'), rows)}\n{more}"


def _messages(rover: Rover) -> str:
    rows = [(row.message.msgname, row.message.id, row.access.value, row.description) for row in rover.messages]
    return _table(("message", "id", "who may", "what it does"), rows)


def _commands(rover: Rover) -> str:
    rows = [
        (f"{int(row.command)}", command_name(row.command), row.who, row.help)
        for row in sorted(rover.commands, key=lambda row: row.command)
    ]
    return _table(("", "MAV_CMD", "who may", "parameters"), rows)


def _items(rover: Rover) -> str:
    do_items = [row.command for row in rover.commands if row.item is not None]
    rows = [
        ("mission", _item_names((*MISSION_RULES, *do_items)), ""),
        ("fence", _item_names(FENCE_RULES), FENCE_NOTE),
        ("rally", _item_names(RALLY_RULES), ""),
    ]
    return _table(("plan", "items", ""), rows)


def _item_names(commands: Iterable[int]) -> str:
    return ", ".join(map(_item_name, commands))


def _item_name(command: int) -> str:
    return FenceItem(command).name if command in FenceItem._value2member_map_ else command_name(command)


def _modes() -> str:
    pairs = {mode: f"{main}/{sub}" for (main, sub), mode in PX4_ALIASES.items()}
    rows = [
        (f"{int(mode.mode)}", mode.mode.name, "driver" if mode.manual else "autonomous" if mode.autonomous else "none",
         "" if mode.requirement.value == "nothing" else mode.requirement.value, mode.standard or "",
         pairs.get(mode.mode, ""),
         "" if mode.selectable else "not selectable")
        for mode in MODES.values()
    ]  # fmt: skip
    return _table(("custom_mode", "name", "who drives", "needs", "standard mode", "PX4's pair", ""), rows)


def _buttons() -> str:
    driver, anyone = Access.DRIVER_OR_UNCLAIMED.value, Access.ANYONE.value
    rows = [(number, each.label, anyone if each.stops else driver) for number, each in FUNCTIONS.items()]
    return _table(("BTNn_FUNCTION", "when pressed", "who may"), [(0, "none", ""), *rows])


def _parameters() -> str:
    rows = []
    for each in TABLE:
        notes = {"not while armed": each.safety, "read only": each.read_only, "after a restart": each.needs_reboot}
        unit = f" {each.unit}" if each.unit else ""
        note = ", ".join(note for note, holds in notes.items() if holds)
        rows.append((each.name, f"{each.default:g}{unit}", f"{each.low:g} to {each.high:g}", each.description, note))
    return _table(("name", "default", "range", "what it does", ""), rows)


def _private(rover: Rover) -> str:
    messages, enums = private_messages(), private_enums()
    used = {field.enum for message in messages for field in message.fields}
    parts = [_message(message, rover.message_ids) for message in messages]
    for name, values in enums.items():
        if name in used:
            parts.append(
                f"### {name}\n\n{_table(('value', 'name', ''), [(v.number, v.name, v.description) for v in values])}"
            )
    return _section("Private messages", "\n".join(parts))


def _message(message: MessageDefinition, inbound: frozenset[int]) -> str:
    fields = [(each.name, each.type, each.enum or each.unit, each.description) for each in message.fields]
    size = m.MESSAGES[message.id].unpacker.size
    title = f"### {message.name} ({message.id}, {size} bytes; {_direction(message.id, inbound)})"
    return f"{title}\n\n{message.description}\n\n{_table(('field', 'type', 'unit, enum', ''), fields)}"


def _direction(number: int, inbound: frozenset[int]) -> str:
    if number in LOG_ONLY:
        return "in logs of the ground station only"
    return "to the vehicle" if number in inbound else "from the vehicle"
