"""`mavhelm --plain`: lines in place of a screen, beside a station that verbs in other shells go through."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence

from groundstation.cli.local.runner import report_mistakes
from groundstation.cli.verb_help import EVERY_VERB
from groundstation.station_socket.about import ask_about
from groundstation.station_socket.connect import running_stations
from groundstation.station_socket.folder import FolderError
from link.runtime.child_process import end_process, start_module

VERB = ("status", "--watch", "--changes")
"""What prints the lines."""

NOT_ABOUT_A_VEHICLE = frozenset({"-h", "--help", "--station"})
"""Options with which no station is started; `--station` chooses one."""

SHARED = ("--config", "--dialect", "--system")
"""Options of the verb that a station takes, too."""

END_WITHIN = 5.0
"""s for the station to end, after neutral, before it is killed."""


def run(arguments: Sequence[str]) -> int:
    """Run a station, unless one has the endpoints, and print what changes until the end; return the exit code.

    `arguments` are those of `mavhelm` without --plain.
    """
    endpoints = [each for each in arguments if not each.startswith("-") and ":" in each]
    options = [each for each in arguments if each not in endpoints and each != "--sitl"]
    options += _aids(options)
    words = [*VERB, *options, *(word for each in endpoints for word in ("-e", each))]
    if NOT_ABOUT_A_VEHICLE.intersection(each.partition("=")[0] for each in options) or _has_station(endpoints):
        return _print_changes(words)
    return report_mistakes(lambda: _run_beside_station(endpoints, options, words, sitl="--sitl" in arguments))


def _has_station(endpoints: Sequence[str]) -> bool:
    """Return whether a station runs that has the endpoints, or any station without them."""
    with contextlib.suppress(FolderError):
        pids = running_stations()
        found = [about for pid in pids if (about := ask_about(pid)) is not None] if endpoints else []
        return any(set(endpoints) <= set(about.endpoints) for about in found) if endpoints else bool(pids)
    return False


def _run_beside_station(endpoints: Sequence[str], options: Sequence[str], words: Sequence[str], *, sitl: bool) -> int:
    """Start the station, print until the end, end it. Raises ConfigError, EndpointError."""
    where = endpoints or ([] if sitl else _usual_endpoints(options))
    given = [*(["--sitl"] if sitl else []), *_shared(options), *where]
    station = start_module(
        "groundstation",
        ["serve", "--headless", *given],
        output=subprocess.PIPE,
        new_session=True,  # Ctrl-C is for this process, which ends the station
        ends_with_us=True,
    )
    assert station.stderr is not None
    with station:
        try:
            line = station.stderr.readline().decode()
            sys.stderr.write(line)
            if not line.startswith(f"station {station.pid} "):  # why it has not started
                return station.wait()
            return _print_changes([*words, f"--station={station.pid}"])
        finally:
            station.terminate()
            end_process(station, END_WITHIN)


def _print_changes(words: Sequence[str]) -> int:
    from groundstation.verbs.main import run as run_verb  # loads the dialect

    return run_verb(words)


def _usual_endpoints(options: Sequence[str]) -> list[str]:
    """Return the endpoints of the environment, of the config file, or the one used last."""
    from groundstation.verbs.session.endpoints import choose_endpoints

    config = dict(zip(("option", "value"), _option(options, "--config"), strict=False)).get("value")
    return choose_endpoints(None, config, os.environ, note=_note, reserved=EVERY_VERB)


def _aids(options: Sequence[str]) -> list[str]:
    """Return --speak and --bell if the config file asks for them and the command line does not say otherwise."""
    from groundstation.config.config_file import ConfigError
    from groundstation.config.effective import load_config, merge

    config = dict(zip(("option", "value"), _option(options, "--config"), strict=False)).get("value")
    try:
        settings = merge(load_config(config, os.environ, EVERY_VERB), os.environ, {}).settings
    except ConfigError:  # told by what needs the file
        return []
    chosen = {"speak": settings.speak, "bell": settings.bell}
    return [f"--{name}" for name, on in chosen.items() if on and not {f"--{name}", f"--no-{name}"} & set(options)]


def _note(text: str) -> None:
    sys.stderr.write(f"mavhelm: {text}\n")


def _shared(options: Sequence[str]) -> list[str]:
    return [word for name in SHARED for word in _option(options, name)]


def _option(options: Sequence[str], name: str) -> Iterator[str]:
    """Yield an option and its value as two words, if it is given."""
    for at, word in enumerate(options):
        option, equals, value = word.partition("=")
        if option == name and (equals or at + 1 < len(options)):
            yield from (name, value if equals else options[at + 1])
