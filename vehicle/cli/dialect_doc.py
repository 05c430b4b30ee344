"""docs/dialect.md: what the vehicle speaks, from the tables that it speaks by. `vehicle dialect` prints it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from dialects import messages as m
from dialects.definition import MessageDefinition, private_enums, private_messages
from dialects.enums import Command, FenceItem
from vehicle.autonomy.mission.rules import FENCE_RULES, MISSION_RULES, RALLY_RULES
from vehicle.commands.buttons import FUNCTIONS
from vehicle.commands.dispatch import COMPONENT
from vehicle.commands.inbound import INBOUND_MESSAGES as HEARD_TABLE
from vehicle.commands.inbound import Access
from vehicle.modes import MODES, PX4_ALIASES
from vehicle.params import TABLE, Params
from vehicle.rover import Rover
from vehicle.telemetry.streams import STREAMS, DialectLevel

ANY, KNOWN, DRIVER = "anybody", "introduced", "driver"
STOPS = f"{DRIVER}; what stops: {ANY}"
"""Who may: without a word more the driver is the station in control, or any introduced one while nobody is."""

TO_WHOM = {
    DialectLevel.COMMON: "",
    DialectLevel.NEWER: "who asks for newer ones",
    DialectLevel.ROVER: "who asks for ours",
}
"""Of streams; without a word everybody."""

PLANS = {
    "mission": (MISSION_RULES, ""),
    "fence": (
        FENCE_RULES,
        "RETURN_POINT, at most one, is only kept and given back: nothing drives there, FENCE_ACTION decides",
    ),
    "rally": (RALLY_RULES, ""),
}
"""Plan -> its items, and what is to be said of them."""

COMMANDS: dict[Command, tuple[str, str]] = {
    Command.COMPONENT_ARM_DISARM: (STOPS, "1: 1 arm, 0 disarm; 2: 21196 or 2989 skips soft checks"),
    Command.RUN_PREARM_CHECKS: (ANY, "says what forbids to arm"),
    Command.DO_SET_MODE: (STOPS, "1: 1 or more with bit 0; 2: mode; HOLD is what stops. PX4's pairs in 2 and 3"),
    Command.DO_SET_STANDARD_MODE: (DRIVER, "1: MAV_STANDARD_MODE, see modes"),
    Command.DO_SET_SAFETY_SWITCH_STATE: (STOPS, "1: 0 emergency stop, 1 release"),
    Command.DO_FLIGHTTERMINATION: (ANY, "1: above 0.5 emergency stop until a restart"),
    Command.REQUEST_OPERATOR_CONTROL: (KNOWN, "1: 1 ask for control, 0 give it up; 2: 1 others may take over"),
    Command.DO_REPOSITION: (DRIVER, "COMMAND_INT; 1: m/s, -1 as usual; 2: 1 changes to GUIDED; x, y: place"),
    Command.DO_CHANGE_SPEED: (DRIVER, "1: 0 or 1; 2: m/s, -1 no change, -2 as usual"),
    Command.DO_SET_REVERSE: (DRIVER, "1: 1 backwards along the path, 0 forwards"),
    Command.DO_SET_HOME: (DRIVER, "1: 1 here; 0: the place in 5 to 7"),
    Command.DO_SET_GLOBAL_ORIGIN: (DRIVER, "disarmed; 5, 6: place that local positions count from"),
    Command.NAV_RETURN_TO_LAUNCH: (DRIVER, "RTL"),
    Command.DO_PAUSE_CONTINUE: (STOPS, "1: 0 stand, 1 go on"),
    Command.MISSION_START: (DRIVER, "1: first item"),
    Command.DO_SET_MISSION_CURRENT: (DRIVER, "1: item, -1 the one under way; 2: 1 forgets the jumps made"),
    Command.DO_FENCE_ENABLE: (DRIVER, "1: 1 on, 0 off; not off while armed, nor against the file of settings"),
    Command.DO_SET_SERVO: (DRIVER, "1: output, 2: us; outputs of motors are denied"),
    Command.DO_REPEAT_SERVO: (DRIVER, "1: output, 2: us, 3: how often there and back, 4: s between two changes"),
    Command.DO_SET_RELAY: (DRIVER, "1: relay, 2: 0 or 1"),
    Command.DO_REPEAT_RELAY: (DRIVER, "1: relay, 2: how often there and back, 3: s between two changes"),
    Command.DO_MOTOR_TEST: (DRIVER, "disarmed; 1: motor from 1, 2: 0 (percent), 3: percent, 4: s up to 3"),
    Command.ACTUATOR_TEST: (DRIVER, "disarmed; 1: -1..1, NaN stops, 2: s up to 3, 0 stops, 5: motor from 1"),
    Command.PREFLIGHT_STORAGE: (
        DRIVER,
        "disarmed; 1: 2 or 4 puts parameters back to their defaults, or to what this run was given; 2: 2 erases the "
        "plans; 1 saves either again",
    ),
    Command.PREFLIGHT_CALIBRATION: (DRIVER, "disarmed; 1: 1 the gyro, at rest for 3 s, told as progress"),
    Command.PREFLIGHT_REBOOT_SHUTDOWN: (
        DRIVER,
        "disarmed, REBOOT_ENABLE; 1: 1 this program, 2 shut down; 2: 1 reboot, 2 shut down",
    ),
    Command.REQUEST_MESSAGE: (KNOWN, "1: message id; 2: index"),
    Command.SET_MESSAGE_INTERVAL: (KNOWN, "1: message id; 2: us, -1 off, 0 as at the start"),
    Command.GET_MESSAGE_INTERVAL: (KNOWN, "1: message id"),
    Command.REQUEST_PROTOCOL_VERSION: (KNOWN, "1: 1"),
    Command.REQUEST_AUTOPILOT_CAPABILITIES: (KNOWN, "1: 1"),
    Command.GET_HOME_POSITION: (KNOWN, "HOME_POSITION"),
    Command.DO_SEND_BANNER: (KNOWN, "says what it is (of ardupilotmega.xml)"),
}
"""Command -> who may, and what its parameters mean. What is not here is answered UNSUPPORTED."""

HEAD = f"""\
# What the vehicle speaks

Printed by `vehicle dialect > docs/dialect.md` from the tables in the code; a test compares the two.

MAVLink 2 (version 1 is understood), component {COMPONENT} (autopilot), type ground rover, autopilot generic. The
message set is pymavlink's common.xml with `dialects/rover.xml`. A **driver** is the ground station in control, or any
introduced one while nobody is; **introduced** is who has shown a HEARTBEAT, or, for questions, who has connected (TCP)
or whose address the user named.
"""


def build_document() -> str:
    """The whole document."""
    return "\n".join(
        (
            HEAD,
            _section("What it tells", _streams()),
            _section("What it listens to", _heard()),
            _section("Commands", _commands()),
            _section("Items of plans", _items()),
            _section("Modes", _modes()),
            _section("Buttons of MANUAL_CONTROL", _buttons()),
            _section("Parameters", _parameters()),
            _private(),
        )
    )


def answered_commands() -> frozenset[int]:
    """Commands that have a handler."""
    return Rover(Params(), now=0.0).commands


def _section(title: str, text: str) -> str:
    return f"## {title}\n\n{text}"


def _table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(str(cell).replace('|', chr(92) + '|') for cell in row)} |\n" for row in lines)


def _streams() -> str:
    rows = [
        (stream.message.msgname, stream.message.id, f"{stream.rate:g}" if stream.rate else "on request",
         "and on change" if stream.change_key else "", TO_WHOM[stream.level], stream.group.name if stream.group else "")
        for stream in STREAMS
    ]  # fmt: skip
    more = (
        "Rates are those at the start, for each ground station apart: SET_MESSAGE_INTERVAL and REQUEST_DATA_STREAM\n"
        "change them for who asks, slow links and full radios stretch them. Who has asked for one of the newer (or\n"
        "for AVAILABLE_MODES, COMPONENT_METADATA, control, a standard mode) gets them all; who has asked for one of\n"
        "ours, or sent ROVER_OPERATOR_PRESENCE, gets ours, too. Everybody else would count them as lost.\n"
        "ROVER_LINK_STATUS comes once a second for each link to who gets ours. The rest are answers.\n"
    )
    return f"{_table(('message', 'id', 'Hz', '', 'to whom', 'REQUEST_DATA_STREAM'), rows)}\n{more}"


def _heard() -> str:
    who = {Access.ANYBODY: ANY, Access.CONNECTED: KNOWN, Access.INTRODUCED: KNOWN, Access.DRIVER: "station in control",
           Access.DRIVER_OR_UNCLAIMED: DRIVER}  # fmt: skip
    rows = [(heard.message.msgname, heard.message.id, who[heard.access], heard.description) for heard in HEARD_TABLE]
    return _table(("message", "id", "of whom", "what it does"), rows)


def _commands() -> str:
    rows = [(f"{int(command)}", command.name, *words) for command, words in sorted(COMMANDS.items())]
    return _table(("", "MAV_CMD", "who may", "parameters"), rows)


def _items() -> str:
    rows = [(plan, ", ".join(_item_name(each) for each in items), words) for plan, (items, words) in PLANS.items()]
    return _table(("plan", "items", ""), rows)


def _item_name(command: int) -> str:
    known = Command if command in Command._value2member_map_ else FenceItem
    return known(command).name


def _modes() -> str:
    pairs = {mode: f"{main}/{sub}" for (main, sub), mode in PX4_ALIASES.items()}
    rows = [
        (f"{int(offer.mode)}", offer.mode.name, "driver" if offer.manual else "itself" if offer.autonomous else "nobody",
         "" if offer.requirement.value == "nothing" else offer.requirement.value, offer.standard or "", pairs.get(offer.mode, ""),
         "" if offer.selectable else "not to be chosen")
        for offer in MODES.values()
    ]  # fmt: skip
    return _table(("custom_mode", "name", "who drives", "needs", "standard mode", "PX4's pair", ""), rows)


def _buttons() -> str:
    rows = [(number, function.label, ANY if function.stops else DRIVER) for number, function in FUNCTIONS.items()]
    return _table(("BTNn_FUNCTION", "as it is pressed", "of whom"), [(0, "nothing", ""), *rows])


def _parameters() -> str:
    rows = []
    for each in TABLE:
        notes = {"not while armed": each.safety, "read only": each.read_only, "after a restart": each.needs_reboot}
        unit = f" {each.unit}" if each.unit else ""
        words = ", ".join(note for note, holds in notes.items() if holds)
        rows.append((each.name, f"{each.default:g}{unit}", f"{each.low:g} to {each.high:g}", each.description, words))
    return _table(("name", "default", "range", "what it does", ""), rows)


def _private() -> str:
    messages, enums = private_messages(), private_enums()
    used = {field.enum for message in messages for field in message.fields}
    parts = [_message(message) for message in messages]
    for name, values in enums.items():
        if name in used:
            parts.append(
                f"### {name}\n\n{_table(('value', 'name', ''), [(v.number, v.name, v.description) for v in values])}"
            )
    return _section("Messages of our own", "\n".join(parts))


def _message(message: MessageDefinition) -> str:
    sender = "the vehicle listens" if message.id in {heard.message.id for heard in HEARD_TABLE} else "the vehicle tells"
    fields = [(each.name, each.type, each.enum or each.unit, each.description) for each in message.fields]
    size = m.MESSAGES[message.id].unpacker.size
    title = f"### {message.name} ({message.id}, {size} bytes; {sender})"
    return f"{title}\n\n{message.description}\n\n{_table(('field', 'type', 'unit, enum', ''), fields)}"
