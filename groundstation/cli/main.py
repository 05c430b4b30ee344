"""Command line of the ground station: chooses between the screen and the verbs. Each loads only what it needs."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Sequence

from link.runtime import startup_gc, stdio, without_openssl

FLAGS = ("--json", "-q", "--quiet")
"""Options of all verbs that may also stand before the verb."""

WITHOUT_STATION = frozenset({"-h", "--help", "--help-all", "--version"})
"""Options that only print."""

PLAIN = "--plain"
"""In place of a screen: lines (groundstation/cli/plain.py)."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the ground station. Returns 0 after a session, 2 for wrong arguments, 1 when the station crashed.

    A verb returns a code of groundstation/verbs/common/exit_codes.py.
    """
    stdio.ensure_open()
    return stdio.run_program("mavhelm", lambda: _run(sys.argv[1:] if arguments is None else arguments))


def _run(arguments: Sequence[str]) -> int:
    arguments = _verb_first(arguments)
    verb = arguments[0] if arguments else ""
    if verb.isalnum():  # it may be a verb; the screen of an endpoint does without the table
        from groundstation.cli.verb_help import LOCAL_VERBS
        from groundstation.verbs.mavproxy_words import describe_action
        from groundstation.verbs.table import VERBS

        if hint := describe_action(arguments, VERBS):
            print(f"mavhelm: {hint}", file=sys.stderr)
            return 2
        if verb in VERBS:
            without_openssl.load()
            with startup_gc.paused():
                from groundstation.verbs.main import run as run_verb  # loads the dialect, which the screen does without

                return run_verb(arguments)
        if verb in LOCAL_VERBS:
            return _run_local(verb, arguments[1:])
    if PLAIN in arguments:
        from groundstation.cli.plain import run as run_plain

        return run_plain([each for each in arguments if each != PLAIN])
    return _run_screen(arguments)


def _run_screen(arguments: Sequence[str]) -> int:
    """Run the screen and its station, which imports its modules while the command line is read."""
    from groundstation.host_process import STATION, HostProcess

    process = None
    if not WITHOUT_STATION.intersection(arguments):
        with contextlib.suppress(OSError):  # it is tried again later, and then shown
            process = HostProcess(STATION)
    try:
        without_openssl.load()
        with startup_gc.paused():
            from groundstation.cli.console import run as run_console

            return run_console(arguments, process)
    finally:
        if process is not None:
            process.end()


def _verb_first(arguments: Sequence[str]) -> Sequence[str]:
    """Return the arguments with --json and -q behind the verb, where its parser takes them."""
    flags = next((at for at, each in enumerate(arguments) if each not in FLAGS), 0)
    if not flags:
        return arguments
    from groundstation.verbs.table import VERBS

    return [*arguments[flags:], *arguments[:flags]] if arguments[flags] in VERBS else arguments


def _run_local(verb: str, arguments: Sequence[str]) -> int:
    """Run a verb without a vehicle."""
    if verb == "config":
        from groundstation.cli.local.config import run
    elif verb == "keys":
        from groundstation.cli.local.keys import run
    elif verb == "attach":
        from groundstation.cli.local.attach import run
    elif verb == "replay":
        from groundstation.cli.local.replay import run
    elif verb == "learn":
        from groundstation.cli.local.learn import run
    elif verb == "serve":
        from groundstation.cli.local.serve import run
    elif verb == "video":
        from groundstation.cli.local.video import run
    else:
        from groundstation.cli.local.completion import run as run_completion
        from groundstation.cli.verb_help import EVERY_VERB

        return run_completion(arguments, {name: verb.help for name, verb in EVERY_VERB.items()})
    return run(arguments)


if __name__ == "__main__":
    raise SystemExit(main())
