"""`mavhelm completion`: prints the script of a shell, and answers that script with the names of a station."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from groundstation.station_socket.names import KINDS, find_names
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.manual.shells import SHELLS
from link.runtime import stdio
from link.runtime.command_line import CommandLineParser


def build_parser() -> CommandLineParser:
    """Return the parser."""
    parser = CommandLineParser(
        prog="mavhelm completion",
        description="Print a script that completes verbs, options and names in a shell.",
        epilog='bash: eval "$(mavhelm completion bash)" in ~/.bashrc; the same for zsh; '
        "fish: mavhelm completion fish | source",
    )
    add = parser.add_mutually_exclusive_group(required=True).add_argument
    add("shell", nargs="?", choices=SHELLS)
    add("--names", choices=KINDS, help="print those that a running station knows; the code is 3 if there are none")
    return parser


def run(arguments: Sequence[str], helps: Mapping[str, str]) -> int:
    """Print the script for a shell, or names; return the exit code. `helps`: verb -> what it does."""
    parser = build_parser()
    options = parser.parse_args(parser.reject_empty(arguments))
    try:
        code = _print_names(options.names) if options.names else _print_script(options.shell, helps)
        sys.stdout.flush()
    except OSError as error:
        return stdio.end_output(error, lambda reason: sys.stderr.write(f"mavhelm: output: {reason}\n"))
    return int(code)


def _print_script(shell: str, helps: Mapping[str, str]) -> ExitCode:
    from groundstation.verbs.completion import build_script  # loads the dialect, which names do without

    sys.stdout.write(build_script(shell, helps))
    return ExitCode.DONE


def _print_names(kind: str) -> ExitCode:
    names = find_names(kind)
    sys.stdout.writelines(f"{name}\n" for name in names)
    return ExitCode.DONE if names else ExitCode.NO_VEHICLE
