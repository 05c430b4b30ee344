"""The words of the vehicle beside running: `vehicle init`, `vehicle check` and others. It reads them and hands over."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from link.runtime import stdio
from link.runtime.command_line import USAGE_ERROR, CommandLineParser
from link.runtime.toml_file import TomlError, read_toml

DONE, FAULT = 0, 1
"""Exit codes: it did what was asked; the hardware did not. MISTAKE is the user's."""
DEFAULT_FILE = "rover.toml"


class SubcommandError(Exception):
    """What was asked for cannot be had; the text is one line."""


@dataclass(frozen=True, slots=True)
class Subcommand:
    """One word: what it takes, what it does."""

    help: str
    options: Callable[[argparse.ArgumentParser], object]
    run: Callable[[argparse.Namespace], int]


def run(words: Sequence[str]) -> int:
    """Do what the first of `words` says; the exit code."""
    parser = build_parser(words[0])
    asked = parser.parse_args(parser.reject_empty(words[1:]))
    try:
        code = SUBCOMMANDS[words[0]].run(asked)
        sys.stdout.flush()
    except (SubcommandError, TomlError) as error:
        parser.exit(USAGE_ERROR, f"{parser.prog}: {error}\n")
    except OSError as error:
        # The verbs name those of their own files: this is the output, full or closed by its reader.
        stdio.discard_output()
        parser.exit(FAULT, f"{parser.prog}: {error.strerror or error}\n")
    return code


def build_parser(word: str) -> CommandLineParser:
    """What reads the rest of the command line after this word."""
    verb = SUBCOMMANDS[word]
    parser = CommandLineParser(prog=f"vehicle {word}", description=f"{verb.help[0].upper()}{verb.help[1:]}.")
    verb.options(parser)
    return parser


def help_lines() -> str:
    """The table as lines for --help."""
    return "\n".join(f"  vehicle {name:<14} {verb.help}" for name, verb in SUBCOMMANDS.items())


def _file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", nargs="?", default=DEFAULT_FILE, metavar="FILE", help=f"default {DEFAULT_FILE}")


def _state_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--state", metavar="FOLDER", help="where the vehicle keeps parameters, if not as its file says")


def _check_options(parser: argparse.ArgumentParser) -> None:
    _file(parser)
    _state_option(parser)


def _nothing(parser: argparse.ArgumentParser) -> None:
    """Takes no options."""


def _init(asked: argparse.Namespace) -> int:
    from vehicle.config.template import build_template

    try:
        with Path(asked.file).open("x", encoding="utf-8") as file:
            file.write(build_template())
    except FileExistsError:
        raise SubcommandError(f"{asked.file} is there already; name another file, or remove it") from None
    except OSError as error:
        raise SubcommandError(f"{asked.file}: {error.strerror}") from error
    sys.stdout.write(f"wrote {asked.file}; edit it, then: vehicle check {asked.file}\n")
    return DONE


def _schema(asked: argparse.Namespace) -> int:
    from vehicle.config.schema import build_schema

    sys.stdout.write(build_schema())
    return DONE


def _dialect(asked: argparse.Namespace) -> int:
    from vehicle.cli.dialect_doc import build_document

    sys.stdout.write(build_document())
    return DONE


def _check(asked: argparse.Namespace) -> int:
    from vehicle.cli.check import run_checks

    code = DONE
    for finding in run_checks(asked.file, asked.state):
        sys.stdout.write(f"{finding}\n")
        sys.stdout.flush()
        if not finding.ok:
            code = max(code, USAGE_ERROR if finding.mistake else FAULT)
    return code


def _config_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--config", default=DEFAULT_FILE, metavar="FILE", help=f"file of settings, {DEFAULT_FILE}")


def _safe_stop(asked: argparse.Namespace) -> int:
    from vehicle.cli.safe_stop import stop_all

    stop_all(asked.config)
    return DONE


def _unit_options(parser: argparse.ArgumentParser) -> None:
    _config_option(parser)
    parser.add_argument(
        "--user", help="who it runs as; default the owner of the home it lives in, else nobody in particular"
    )
    parser.add_argument(
        "--power", choices=("reboot", "poweroff"), help="print the unit that does this when a ground station asks"
    )


def _systemd_unit(asked: argparse.Namespace) -> int:
    from vehicle.cli.safe_stop import read_motor_table
    from vehicle.cli.systemd_unit import UnitOptions, build_power_unit, build_unit, existing_groups, home_owner

    if asked.power:
        sys.stdout.write(build_power_unit(asked.power))
        return DONE
    config, python = Path(asked.config).absolute(), Path(sys.executable)
    table = read_motor_table(asked.config)
    user = asked.user or home_owner(config, python)
    params = read_toml(asked.config).get("params")
    power = isinstance(params, dict) and params.get("REBOOT_ENABLE") == 2
    place = UnitOptions(config, python, existing_groups(), user, str(table["driver"]), power)
    sys.stdout.write(build_unit(place))
    return DONE


def _motor_test_options(parser: argparse.ArgumentParser) -> None:
    _config_option(parser)
    _state_option(parser)
    parser.add_argument("motor", metavar="MOTOR", help="its number from 1, or its name: left, right, throttle, ...")
    parser.add_argument("--throttle", type=float, default=0.15, metavar="N", help="-0.3 to 0.3 (default 0.15)")
    parser.add_argument("--time", type=float, default=1.0, metavar="S", help="seconds, at most 3 (default 1)")
    parser.add_argument("--yes", action="store_true", help="do not ask: the wheels are in the air")


def _motor_test(asked: argparse.Namespace) -> int:
    from vehicle.cli.motor_test import RefusedError, build_options, run_motor_test
    from vehicle.cli.safe_stop import read_motor_table
    from vehicle.config.config import ConfigError, load
    from vehicle.config.effective_params import load_effective_params
    from vehicle.motors import MotorError

    try:
        config = load(asked.config)
        known = load_effective_params(config, asked.state)
        if known.damage:  # the wheel might turn the other way than the vehicle would turn it
            raise SubcommandError(f"{known.folder}: {known.damage}")
        for problem in known.left_out:
            sys.stderr.write(f"vehicle motor-test: a kept parameter is not used: {problem}\n")
        wanted = build_options(asked.motor, asked.throttle, asked.time, known.params)
        read_motor_table(asked.config)
        if not asked.yes:
            _ask(
                f"Motor {asked.motor} at {asked.throttle:+.0%} for {asked.time:g} s. Are the wheels in the air? [y/N] "
            )
        ended = run_motor_test(config.motors, wanted)
    except (ConfigError, RefusedError) as error:
        raise SubcommandError(str(error)) from error
    except MotorError as error:
        sys.stderr.write(f"vehicle motor-test: {error}\n")
        return FAULT
    sys.stderr.write(f"vehicle motor-test: {f'stopped by {ended.name}' if ended else 'done'}, motors neutral\n")
    return DONE


def _ask(question: str) -> None:
    """Raises VerbError unless somebody at a terminal says yes."""
    if not sys.stdin.isatty():
        raise SubcommandError("a wheel is going to turn; with the wheels in the air say --yes")
    sys.stderr.write(question)
    sys.stderr.flush()
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise SubcommandError("nothing was turned")


SUBCOMMANDS: dict[str, Subcommand] = {
    "init": Subcommand("write a file of settings with every key and its default", _file, _init),
    "check": Subcommand("check that file and try the hardware, without moving anything", _check_options, _check),
    "schema": Subcommand("print the JSON schema of that file, for editors", _nothing, _schema),
    "dialect": Subcommand("print what the vehicle speaks: messages, commands, modes, parameters", _nothing, _dialect),
    "motor-test": Subcommand("turn one motor, slowly and shortly", _motor_test_options, _motor_test),
    "safe-stop": Subcommand("stop the motors that a killed vehicle left turning", _config_option, _safe_stop),
    "systemd-unit": Subcommand(
        "print the systemd unit that runs the vehicle as a service", _unit_options, _systemd_unit
    ),
}
"""Every word, in the order of --help."""
