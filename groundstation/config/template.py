"""The commented file that `mavhelm config init` writes, with every setting and its default."""

from __future__ import annotations

import json
import textwrap
from typing import Any

from groundstation.config.settings import ROWS, SettingRow

WIDTH = 116

HEAD = """\
# Settings of the ground station: `mavhelm config check` checks this file, `config show` prints what holds.
#
# A line like "#key = value", without a space after #, is a setting: remove the # to set it. The value shown is the
# default, or an example if there is no default. The command line and MAVHELM_ENDPOINT win over this file.
"""

EXAMPLES: dict[str, Any] = {
    "gamepad": "any",
    "theme": "light",
    "ascii": True,
    "folder": "~/rover",
    "log_file": "~/rover/groundstation.log",
    "dialect": "mine.xml",
    "sign_key": "laptop",
    "param_docs": "apm.pdef.xml",
    "record_folder": "~/rover/logs",
}
"""Setting without a default -> what the file shows."""

TABLE_EXAMPLES = {
    "endpoints": (
        'field = "udpout:192.168.1.20:14550"',
        'radio = ["serial:/dev/ttyUSB0:57600", "udpin:0.0.0.0:14550"]',
    ),
    "groups": ('north = "1-20,31"', 'boats = ["*boat*", "7"]'),
    "pad": ('deadman = "leftshoulder"', 'throttle = "triggers"', "expo = 0.5", 'y = "vehicle.control"'),
    "keys": ('drive.forward = ["e", "up"]', 'app.log = "f2"'),
}
"""Table -> its example lines."""


def build_template() -> str:
    """Return the text of the file."""
    return HEAD + "".join(_table(row) if row.name in TABLE_EXAMPLES else _setting(row) for row in ROWS.values())


def _setting(row: SettingRow) -> str:
    value = EXAMPLES.get(row.name, row.default)
    return f"\n{_comment(row)}#{row.name} = {json.dumps(value)}\n"


def _table(row: SettingRow) -> str:
    examples = "".join(f"#{line}\n" for line in TABLE_EXAMPLES[row.name])
    return f"\n{_comment(row)}[{row.name}]\n{examples}"


def _comment(row: SettingRow) -> str:
    allowed = "" if row.name in TABLE_EXAMPLES else f" {row.allowed[0].upper()}{row.allowed[1:]}."
    default = f" Default: {row.option.default}." if row.option is not None and row.option.default else ""
    lines = textwrap.wrap(f"{row.help}{allowed}{default}", WIDTH)
    return "".join(f"# {line}\n" for line in lines)
