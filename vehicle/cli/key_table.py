"""The table of `vehicle key`: its actions and their arguments. key_command.py has what they do, and loads with them."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from link.signing.key_options import ENTERED, SHOWN, Options
from vehicle.cli.subcommand import Subcommand


def _later(name: str) -> Callable[[argparse.Namespace], int]:
    """Return the function `name` of key_command.py, which is imported when it runs."""

    def run(options: argparse.Namespace) -> int:
        from vehicle.cli import key_command

        code: int = getattr(key_command, name)(options)
        return code

    return run


_NAME: Options = {"name": {"metavar": "NAME", "help": "name of the key, e.g. of the computer that holds it"}}
_WHICH: Options = {"name": {"metavar": "NAME", "help": "name or fingerprint of the key"}}
_ANY: Options = {"name": {"nargs": "?", "metavar": "NAME", "help": "name or fingerprint; not needed for the only key"}}
_PLACE: Options = {
    "--config": {"metavar": "FILE", "help": "configuration file of the vehicle, default rover.toml if it is here"},
    "--state": {"metavar": "FOLDER", "help": "state folder of the vehicle, if not the one of its file"},
}
_ROLE: Options = {
    "--role": {"choices": ("watch", "drive", "setup"), "default": "drive",
               "help": "what its holder may do: watch; also drive (default); also set up: parameters, plans, files"},
}  # fmt: skip
KEY = Subcommand(
    "make, show, install, list, choose or revoke keys for MAVLink signing",
    actions={
        "new": Subcommand("make a key", _later("new"), _NAME | _ROLE | _PLACE, SHOWN),
        "show": Subcommand("print name, role and fingerprint of a key; the secret on request only", _later("show"),
                           _ANY | _PLACE, SHOWN),
        "install": Subcommand("add a key that was made elsewhere", _later("install"), _NAME | _ROLE | _PLACE, ENTERED,
                              need_one=True),
        "list": Subcommand("print all keys without their secrets; > marks the one that signs", _later("list_keys"),
                           _PLACE),
        "use": Subcommand("sign what goes to everybody with this key", _later("use"), _WHICH | _PLACE),
        "revoke": Subcommand("remove a key, so that its holder can do nothing any more", _later("revoke"),
                             _WHICH | _PLACE),
    },
)  # fmt: skip
