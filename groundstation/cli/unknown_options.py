"""Error text for unknown options: what the user may have meant, among our options and those of MAVProxy."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

MAVPROXY_OPTIONS = {
    "--master": "write the endpoint without an option, e.g. udpin:127.0.0.1:14550",
    "--baudrate": "write serial:PATH:BAUD, e.g. serial:/dev/ttyUSB0:57600",
    "--out": "the program `mavhelm bridge` forwards to other ground stations",
    "--source-system": "use --system",
    "--logfile": "use --log-file",
    "--aircraft": "use --log-file",
    "--target-system": "every vehicle is found; a key selects the next one",
    "--console": "the screen shows what it would; leave it out",
    "--map": "the screen shows the track; leave it out",
    "--load-module": "there are no modules; leave it out",
    "--streamrate": "telemetry is requested to fit the link; leave it out",
    "--mav10": "MAVLink 1 is understood and MAVLink 2 is sent; leave it out",
}
"""Option of MAVProxy -> what to use here."""

SYNONYMS = {"--baud": "--baudrate", "--sysid": "--source-system", "--mav20": "--mav10"}


def describe_unknown(arguments: Sequence[str], options: Sequence[str]) -> str:
    """Return one line that names the unknown arguments and what to write instead. `options` are the known ones."""
    hints = (_hint(argument.partition("=")[0], options) for argument in arguments if argument.startswith("--"))
    hint = next(filter(None, hints), "")
    return f"unrecognized arguments: {' '.join(arguments)}{hint and f': {hint}'}"


def _hint(name: str, options: Sequence[str]) -> str:
    mavproxy = MAVPROXY_OPTIONS.get(SYNONYMS.get(name, name))
    if mavproxy is not None:
        return mavproxy
    near = difflib.get_close_matches(name, options, n=1, cutoff=0.7)
    return f"did you mean {near[0]}?" if near else ""
