"""The subcommands of the vehicle: `mavhelm vehicle init`, `mavhelm vehicle check` and others.

To add a subcommand, add its function here and a row to SUBCOMMANDS, with its arguments.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from link.runtime import stdio
from link.runtime.command_line import USAGE_ERROR, CommandLineParser
from link.signing.key_options import ENTERED, SHOWN, Options
from link.toml.file import TomlError, read_toml
from vehicle.cli.subcommand import DONE, FAULT, Subcommand, SubcommandError


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


INTERRUPTED = 130
"""Exit code after Ctrl-C, 128 + SIGINT."""
DEFAULT_FILE = "rover.toml"


def run(arguments: Sequence[str]) -> int:
    """Execute the subcommand that `arguments` starts with and return the exit code."""
    parser = build_parser(arguments[0])
    options = parser.parse_args(parser.reject_empty(arguments[1:]))
    try:
        code: int = options.run(options)
        sys.stdout.flush()
    except (SubcommandError, TomlError) as error:
        parser.exit(USAGE_ERROR, f"{parser.prog}: {error}\n")
    except KeyboardInterrupt:
        return INTERRUPTED
    except OSError as error:
        # Errors of files are reported with their names: this is the output, full or closed by its reader.
        return stdio.end_output(error, lambda reason: parser.exit(FAULT, f"{parser.prog}: {reason}\n"))
    return code


def build_parser(name: str) -> CommandLineParser:
    """Return the parser for the arguments of a subcommand."""
    parser = CommandLineParser(prog=f"mavhelm vehicle {name}")
    SUBCOMMANDS[name].add_to(parser)
    return parser


def help_lines() -> str:
    """Return the table as lines for --help."""
    return "\n".join(f"  mavhelm vehicle {name:<14} {subcommand.help}" for name, subcommand in SUBCOMMANDS.items())


def _init(options: argparse.Namespace) -> int:
    from vehicle.config.template import build_template

    try:
        with Path(options.file).open("x", encoding="utf-8") as file:
            file.write(build_template())
    except FileExistsError:
        raise SubcommandError(f"{options.file} exists already; choose another name, or remove it") from None
    except OSError as error:
        raise SubcommandError(f"{options.file}: {error.strerror}") from error
    sys.stdout.write(f"wrote {options.file}; edit it, then run: mavhelm vehicle check {options.file}\n")
    return DONE


def _schema(options: argparse.Namespace) -> int:
    from vehicle.config.schema import build_schema

    sys.stdout.write(build_schema())
    return DONE


def _dialect(options: argparse.Namespace) -> int:
    from vehicle.cli.dialect_doc import build_document

    sys.stdout.write(build_document())
    return DONE


def _check(options: argparse.Namespace) -> int:
    from vehicle.cli.check import run_checks

    code = DONE
    for result in run_checks(options.file, options.state):
        sys.stdout.write(f"{result}\n")
        sys.stdout.flush()
        if not result.ok:
            code = max(code, USAGE_ERROR if result.user_error else FAULT)
    return code


def _doctor(options: argparse.Namespace) -> int:
    import json

    from link.runtime.diagnosis import STOPPED, find_faults, format_row, row_record
    from vehicle.cli.doctor.gather import gather_facts
    from vehicle.cli.doctor.table import examine

    rows = examine(gather_facts(options.file, options.state))
    faults = find_faults(rows)
    for row in rows:
        lines = [json.dumps(row_record(row))] if options.json else format_row(row)
        sys.stdout.writelines(f"{line}\n" for line in lines)
    if options.json:
        sys.stdout.write(json.dumps({"ok": not faults, "faults": [row.id for row in faults]}) + "\n")
    return STOPPED if faults else DONE


def _safe_stop(options: argparse.Namespace) -> int:
    from vehicle.cli.safe_stop import stop_all

    stop_all(options.config)
    return DONE


def _systemd_unit(options: argparse.Namespace) -> int:
    from vehicle.cli.safe_stop import read_motor_table
    from vehicle.cli.systemd_unit import UnitOptions, build_power_unit, build_unit, existing_groups, home_owner

    if options.power:
        sys.stdout.write(build_power_unit(options.power))
        return DONE
    config, python = Path(options.config).absolute(), Path(sys.executable)
    motors = read_motor_table(options.config)
    user = options.user or home_owner(config, python)
    params = read_toml(options.config).get("params")
    power = isinstance(params, dict) and params.get("REBOOT_ENABLE") == 2
    sys.stdout.write(build_unit(UnitOptions(config, python, existing_groups(), user, str(motors["driver"]), power)))
    return DONE


def _motor_test(options: argparse.Namespace) -> int:
    from vehicle.cli.motor_test import RefusedError, build_options, run_motor_test
    from vehicle.cli.safe_stop import read_motor_table
    from vehicle.config.config import RoverConfigError, load
    from vehicle.config.effective_params import load_effective_params
    from vehicle.motors import MotorError

    try:
        config = load(options.config)
        effective = load_effective_params(config, options.state)
        if effective.damage:  # the motor could turn in another direction than with the vehicle's parameters
            raise SubcommandError(f"{effective.folder}: {effective.damage}")
        for problem in effective.left_out:
            sys.stderr.write(f"mavhelm vehicle motor-test: a saved parameter is not used: {problem}\n")
        test = build_options(options.motor, options.throttle, options.time, effective.params)
        read_motor_table(options.config)
        if not options.yes:
            _confirm(
                f"Motor {options.motor} at {options.throttle:+.0%} for {options.time:g} s. "
                "Are the wheels in the air? [y/N] "
            )
        ended = run_motor_test(config.motors, test)
    except (RoverConfigError, RefusedError) as error:
        raise SubcommandError(str(error)) from error
    except MotorError as error:
        sys.stderr.write(f"mavhelm vehicle motor-test: {error}\n")
        return FAULT
    sys.stderr.write(f"mavhelm vehicle motor-test: {f'stopped by {ended.name}' if ended else 'done'}, motors neutral\n")
    return DONE


def _confirm(question: str) -> None:
    """Raise SubcommandError unless the user confirms at a terminal."""
    if not sys.stdin.isatty():
        raise SubcommandError("a wheel will turn; lift the wheels off the ground and add --yes")
    sys.stderr.write(question)
    sys.stderr.flush()
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise SubcommandError("not confirmed, no motor was turned")


_FILE: dict[str, dict[str, Any]] = {
    "file": {"nargs": "?", "default": DEFAULT_FILE, "metavar": "FILE", "help": f"default {DEFAULT_FILE}"}
}
_CONFIG: dict[str, dict[str, Any]] = {
    "--config": {"default": DEFAULT_FILE, "metavar": "FILE", "help": f"configuration file, default {DEFAULT_FILE}"}
}
_STATE: dict[str, dict[str, Any]] = {
    "--state": {"metavar": "FOLDER", "help": "state folder of the vehicle, if not the one of its file"}
}
_JSON: dict[str, dict[str, Any]] = {"--json": {"action": "store_true", "help": "print one JSON object per row"}}

SUBCOMMANDS: dict[str, Subcommand] = {
    "init": Subcommand("write a configuration file with every key and its default", _init, _FILE),
    "check": Subcommand("check the configuration file and the hardware, without moving anything", _check,
                        _FILE | _STATE),
    "doctor": Subcommand("examine all that the vehicle needs on this computer, and what to do; nothing moves", _doctor,
                         _FILE | _STATE | _JSON),
    "schema": Subcommand("print the JSON schema of the configuration file, for editors", _schema),
    "dialect": Subcommand("print the supported messages, commands, modes and parameters", _dialect),
    "motor-test": Subcommand("turn one motor, slowly and briefly", _motor_test, _CONFIG | _STATE | {
        "motor": {"metavar": "MOTOR", "help": "its number from 1, or its name: left, right, throttle, ..."},
        "--throttle": {"type": float, "default": 0.15, "metavar": "N", "help": "-0.3 to 0.3 (default 0.15)"},
        "--time": {"type": float, "default": 1.0, "metavar": "S", "help": "seconds, at most 3 (default 1)"},
        "--yes": {"action": "store_true", "help": "skip the question: the wheels are in the air"},
    }),
    "key": KEY,
    "safe-stop": Subcommand("stop the motors that a killed vehicle left running", _safe_stop, _CONFIG),
    "systemd-unit": Subcommand("print the systemd unit that runs the vehicle as a service", _systemd_unit, _CONFIG | {
        "--user": {"help": "user of the service; default: the owner of the home directory that contains the file or "
                           "Python, otherwise a dynamic user"},
        "--power": {"choices": ("reboot", "poweroff"),
                    "help": "print the unit that executes this request of a ground station"},
    }),
}  # fmt: skip
"""Every subcommand, in the order of --help."""
