"""`mavhelm config`: check, show or create the config file. Needs no vehicle and no screen."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from enum import IntEnum

import msgspec

from groundstation.cli.local.runner import load_settings
from groundstation.cli.options import add_config, add_settings
from groundstation.cli.verb_help import EVERY_VERB, local_examples
from groundstation.config.config_file import ConfigError, choose_path, read_config
from groundstation.config.effective import build_keymap, resolve_endpoints
from groundstation.config.settings import ROWS, format_value
from groundstation.config.template import build_template
from groundstation.input.keymap import KeymapError
from link.endpoint import EndpointError
from link.runtime.command_line import CommandLineParser

EPILOG = """\
exit codes: 0 done, or no mistake; 2 a mistake in the file or the arguments; 7 there is no file

The file is that of --config, else of the variable MAVHELM_CONFIG, else the one that `mavhelm config path` prints.
"""


class _Code(IntEnum):
    """Exit codes, those of groundstation/verbs/common/exit_codes.py, which loads the dialect."""

    DONE = 0
    USAGE = 2
    DIFFERS = 7


def run(arguments: Sequence[str]) -> int:
    """Run `mavhelm config`; return the exit code."""
    parser = build_parser()
    options = parser.parse_args(parser.reject_empty(arguments))
    try:
        return ACTIONS[options.action](options)
    except ConfigError as error:
        _print_errors(*error.problems)
    except (EndpointError, KeymapError) as error:
        _print_errors(str(error))
    except BrokenPipeError:
        raise  # the reader has gone, which is not a mistake
    except OSError as error:
        _print_errors(f"{error.filename or 'output'}: {error.strerror}")
    return _Code.USAGE


def _check(options: argparse.Namespace) -> int:
    path, named = choose_path(options.file or options.config, os.environ)
    if not named and not path.exists():
        _print_errors(f"there is no {path}, so the defaults hold; `mavhelm config init` writes one")
        return _Code.DIFFERS
    read_config(path, EVERY_VERB)
    _print(f"{path}: no mistakes")
    return _Code.DONE


def _show(options: argparse.Namespace) -> int:
    effective = load_settings(options)
    build_keymap(effective.settings)
    resolve_endpoints(effective.settings.open, effective.settings)
    values = msgspec.to_builtins(effective.settings)
    lines = []
    for name, row in ROWS.items():
        source = effective.sources.get(name)
        lines.append((name, source or "default", format_value(values[name]) if source else row.default_text or "--"))
    width = max(len(source) for _, source, _ in lines)
    for name, source, text in lines:
        _print(f"{name:<13}  {source:<{width}}  {text}")
    return _Code.DONE


def _path(options: argparse.Namespace) -> int:
    _print(str(choose_path(options.config, os.environ)[0]))
    return _Code.DONE


def _init(options: argparse.Namespace) -> int:
    path, _ = choose_path(options.file or options.config, os.environ)
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(build_template())
    except FileExistsError:
        _print_errors(f"{path} exists already, and is not changed")
        return _Code.USAGE
    _print(str(path))
    return _Code.DONE


ACTIONS: Mapping[str, Callable[[argparse.Namespace], int]] = {
    "check": _check,
    "show": _show,
    "path": _path,
    "init": _init,
}

_HELP = {
    "check": "check a file: one line for each mistake",
    "show": "print all settings and where each value comes from",
    "path": "print where the file is",
    "init": "write a file with all settings as comments; never overwrites one",
}


_FORMAT = argparse.RawDescriptionHelpFormatter


def build_parser() -> CommandLineParser:
    """Return the parser for the arguments behind `config`."""
    parser = CommandLineParser(
        prog="mavhelm config", epilog=f"{local_examples('config')}\n\n{EPILOG}", formatter_class=_FORMAT
    )
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION", parser_class=CommandLineParser)
    for name, text in _HELP.items():
        action = actions.add_parser(
            name, help=text, description=f"{text[0].upper()}{text[1:]}.", epilog=EPILOG, formatter_class=_FORMAT
        )
        add_config(action)
        if name in ("check", "init"):
            action.add_argument("file", nargs="?", metavar="FILE")
        if name == "show":
            action.add_argument("endpoints", nargs="*", metavar="ENDPOINT|NAME")
            add_settings(action)
    return parser


def _print(text: str) -> None:
    sys.stdout.write(f"{text}\n")


def _print_errors(*lines: str) -> None:
    for line in lines:
        sys.stderr.write(f"mavhelm: {line}\n")
