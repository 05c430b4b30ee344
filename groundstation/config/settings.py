"""Settings: the table of all settings of the ground station.

A row is a field: its name is the key in groundstation.toml, its type has the range, its docstring is the help of the
file and of the command line, and Option the option of the command line. To add a setting, add a field here.
"""

from __future__ import annotations

import contextlib
import json
import os
from enum import StrEnum
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import msgspec

from groundstation.config.defaults import DEFAULT_ENDPOINT
from groundstation.input.pad_mapping import OFF
from groundstation.input.style import HIGHEST_LIMIT, LOWEST_LIMIT, Style
from groundstation.intents.vehicle import HIGHEST_TAKE_OFF, LOWEST_TAKE_OFF, TAKE_OFF_ALTITUDE
from link.runtime.docstrings import field_docs

TEXTS = 'text in "quotes", or a list of texts'


class ThemeName(StrEnum):
    """The themes; groundstation/ui/look/themes.py has their colours."""

    DARK = "dark"
    LIGHT = "light"
    HIGH_CONTRAST = "high-contrast"
    COLOUR_BLIND = "colour-blind"
    NO_COLOUR = "no-colour"


class Option(msgspec.Struct, frozen=True):
    """The option of the command line for a setting."""

    flag: str
    metavar: str | None = None
    default: str = ""
    """What the help says about the default; "" for the default value itself."""
    unit: str = ""
    """Of a number, e.g. "m"."""


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All settings."""

    open: str | tuple[str, ...] = DEFAULT_ENDPOINT
    """Where vehicles are, if the command line does not say so: endpoints, or names of [endpoints]."""
    system: Annotated[int, msgspec.Meta(ge=1, le=255), Option("--system", "ID")] = 255
    """Our MAVLink system id."""
    style: Annotated[Style, Option("--style")] = Style.HOLD
    """How keys drive. hold: while a key is held; latch: until the next key; step: each press adds 10 %."""
    speed: Annotated[float, msgspec.Meta(ge=LOWEST_LIMIT, le=HIGHEST_LIMIT), Option("--speed", "FRACTION")] = 0.6
    """Limit of the sticks."""
    take_off: Annotated[
        float, msgspec.Meta(ge=LOWEST_TAKE_OFF, le=HIGHEST_TAKE_OFF), Option("--take-off", "METRES", unit="m")
    ] = TAKE_OFF_ALTITUDE
    """Altitude above the ground to which the key T takes off a copter. docs/copters.md."""
    keymap: Annotated[str, Option("--keys", "NAME|FILE")] = "standard"
    """Key map: standard, teleop, or a TOML file."""
    gamepad: Annotated[str, Option("--gamepad", "NAME|any|off")] = OFF
    """Drive with a gamepad as well: part of its name, or any; needs the extra [gamepad]. docs/gamepad.md."""
    theme: Annotated[ThemeName | None, Option("--theme", None, "dark; no-colour if NO_COLOR is set")] = None
    """Colours of the screen."""
    ascii: Annotated[bool | None, Option("--ascii", None, "where the locale is not UTF-8, and with TERM=linux")] = None
    """Draw with ASCII characters only."""
    reduce_motion: Annotated[bool, Option("--reduce-motion")] = False
    """Nothing on the screen moves by itself: no spinners, no animations, no blinking cursor."""
    speak: Annotated[bool, Option("--speak")] = False
    """Say what changes: by speech-dispatcher, espeak-ng, or say on macOS. docs/accessibility.md."""
    bell: Annotated[bool, Option("--bell")] = False
    """Ring the bell of the terminal for what must not be missed: a lost link, a failsafe, a stop."""
    cursor: Annotated[bool, Option("--cursor")] = False
    """Show the cursor of the terminal on the focused row, for screen readers."""
    keep: Annotated[bool, Option("--keep")] = False
    """Keep the station when the screen is killed or hung up, as by SSH: it goes neutral; `mavhelm attach`."""
    folder: Annotated[str | None, Option("--folder", "FOLDER", "that of the log file")] = None
    """Folder in which the screens save files."""
    log_file: Annotated[str | None, Option("--log-file", "FILE", "groundstation.log in the user's log folder")] = None
    """Log of the program itself."""
    dialect: Annotated[str | None, Option("--dialect", "FILE.xml", "the built-in one alone")] = None
    """MAVLink definitions of a vehicle that sends messages of its own."""
    sign_key: Annotated[str | None, Option("--sign-key", "NAME", "the one that `mavhelm sign use` chose")] = None
    """Key that signs what we send; `mavhelm sign list` shows all."""
    require_signing: Annotated[bool, Option("--require-signing")] = False
    """Ignore everything that is not signed with a key of ours. Else only what has the ids of a system that signs."""
    param_docs: Annotated[str | None, Option("--param-docs", "FILE", "those in the configuration folder")] = None
    """Texts of parameters: apm.pdef.xml, apm.pdef.json or PX4's parameters.json."""
    record: Annotated[bool, Option("--record")] = True
    """Record each session: what is received and sent, keys, decisions."""
    record_folder: Annotated[str | None, Option("--record-to", "FOLDER", "that of --folder")] = None
    """Folder of the recordings."""
    record_file_size: Annotated[int, msgspec.Meta(ge=1, le=10_000)] = 100
    """MB after which a recording goes on in the next file."""
    record_folder_size: Annotated[int, msgspec.Meta(ge=1, le=1_000_000)] = 2000
    """MB of all recordings in the folder; the oldest are removed."""
    record_video: Annotated[bool, Option("--record-video")] = True
    """Record the pictures of the camera beside them, while a screen shows them."""
    record_video_folder_size: Annotated[int, msgspec.Meta(ge=10, le=1_000_000)] = 2000
    """MB of all recorded pictures in the folder; the oldest are removed."""
    endpoints: dict[str, str | tuple[str, ...]] = {}
    """Names for endpoints: `mavhelm field` opens what `field` names, one endpoint or a list."""
    groups: dict[str, str | tuple[str, ...]] = {}
    """Groups of vehicles for `--group` of verbs: system ids, ranges, patterns of names, as text or a list of texts."""
    keys: dict[str, Any] = {}
    """Keys of single actions, in place of those of the key map. --keys on the command line leaves them out."""

    pad: dict[str, Any] = {}
    """Axes and buttons of the gamepad, in place of the usual ones; docs/gamepad.md lists their names."""

    @property
    def dialect_path(self) -> str | None:
        """The path of the further dialect."""
        return os.path.expanduser(self.dialect) if self.dialect else None


class SettingRow(msgspec.Struct, frozen=True):
    """One row of the table."""

    name: str
    kind: Any
    """Its type, for msgspec."""
    default: Any
    help: str
    option: Option | None

    @property
    def is_switch(self) -> bool:
        """It is true or false."""
        return isinstance(self._info, msgspec.inspect.BoolType)

    @property
    def choices(self) -> list[str] | None:
        """Its values, where they are listed."""
        info = self._info
        return [str(each.value) for each in info.cls] if isinstance(info, msgspec.inspect.EnumType) else None

    @property
    def allowed(self) -> str:
        """What is allowed, for people: "a number from 0.1 to 1"."""
        info = self._info
        if isinstance(info, msgspec.inspect.IntType | msgspec.inspect.FloatType):
            unit = f" {self.option.unit}" if self.option is not None and self.option.unit else ""
            return f"a number from {info.ge:g} to {info.le:g}{unit}"
        if self.choices:
            return f"one of {', '.join(self.choices)}"
        if self.is_switch:
            return "true or false"
        return TEXTS if self.name == "open" else 'text in "quotes"'

    def refuse(self, value: object, shown: str) -> str:
        """Return why a value that `convert` refuses is not taken; a percentage in place of a fraction is explained."""
        hint = ""
        with contextlib.suppress(TypeError, ValueError, msgspec.ValidationError):
            percent = float(value)  # type: ignore[arg-type]  # anything: the error says that it is not a number
            if percent > 1 and isinstance(self._info, msgspec.inspect.FloatType) and self._info.le == 1:
                hint = f"; {percent:g} % is {self.convert(percent / 100):g}"
        return f"{shown} is not {self.allowed}{hint}"

    @property
    def default_text(self) -> str:
        """What holds without the setting, for people; "" if there is nothing to say."""
        if self.option is not None and self.option.default:
            return self.option.default
        return "" if self.is_switch or not self.default else format_value(self.default)

    @property
    def _info(self) -> msgspec.inspect.Type:
        info = msgspec.inspect.type_info(self.kind)
        if not isinstance(info, msgspec.inspect.UnionType):
            return info
        return next(each for each in info.types if not isinstance(each, msgspec.inspect.NoneType))

    def convert(self, value: object, *, strict: bool = True) -> Any:
        """Return a value of its type; without `strict` a number may be a text. Raises msgspec.ValidationError."""
        return msgspec.convert(value, self.kind, strict=strict)


def format_value(value: Any) -> str:
    """Return a value for people: texts without quotes, a list or a table as JSON."""
    return str(value) if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _rows() -> tuple[SettingRow, ...]:
    docs, kinds = field_docs(Settings), get_type_hints(Settings, include_extras=True)
    rows = []
    for each in msgspec.structs.fields(Settings):
        kind = kinds[each.name]
        notes = get_args(kind)[1:] if get_origin(kind) is Annotated else ()
        option = next((note for note in notes if isinstance(note, Option)), None)
        default = {} if each.default_factory is not msgspec.NODEFAULT else each.default
        rows.append(SettingRow(each.name, kind, default, docs[each.name], option))
    return tuple(rows)


ROWS = {row.name: row for row in _rows()}
"""The table by name, in the order of the template."""
