"""The words that complete a line: verbs, actions, options, and names, also those of the vehicle."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from groundstation.natural_order import natural_key
from groundstation.station_socket.names import MODES, plain_names
from groundstation.vehicles.services import VehicleServices
from groundstation.verbs.action import ONLY, VerbAction
from groundstation.verbs.completion import NAMES, USUAL
from groundstation.verbs.table import VERBS

MOST = 40
"""Words that are proposed at once."""


def complete(text: str, services: VehicleServices | None) -> tuple[str, ...]:
    """Return the words that may stand in place of the last one of `text`, which may be empty."""
    words = text.split(" ")
    last = words[-1].lower()
    found = _candidates(words[:-1], services)
    return tuple(word for word in found if word.lower().startswith(last))[:MOST]


def _candidates(before: Sequence[str], services: VehicleServices | None) -> Iterable[str]:
    if not before:
        return [verb for verb, row in VERBS.items() if any(_runs(action) for action in row.actions.values())]
    actions = VERBS[before[0]].actions if before[0] in VERBS else {}
    if ONLY in actions:
        return _arguments(actions[ONLY], len(before) - 1, services)
    if len(before) == 1:
        return [name for name, action in actions.items() if _runs(action)]
    action = actions.get(before[1])
    return [] if action is None else _arguments(action, len(before) - 2, services)


def _runs(action: VerbAction) -> bool:
    return not action.line.elsewhere


def _arguments(action: VerbAction, at: int, services: VehicleServices | None) -> list[str]:
    """Return the names that argument `at` may be, then the options."""
    positional = [settings for name, settings in action.arguments if not name.startswith("-")]
    options = [name for name, _ in action.arguments if name.startswith("--")]
    if not positional:
        return options
    settings = positional[min(at, len(positional) - 1)]
    repeats = settings.get("nargs") in ("*", "+")
    names = _names(str(settings.get("metavar", "")), services) if at < len(positional) or repeats else []
    return [*names, *options]


def _names(kind: str, services: VehicleServices | None) -> list[str]:
    """Return the words that an argument of this kind may be; the modes and parameters are those of the vehicle.

    Its names that a line would read as several words, or as an option, are left out.
    """
    if kind == "MODE":
        return list(USUAL[MODES]) if services is None else plain_names(mode.name for mode in services.modes.modes)
    if services is not None and kind in ("NAME", "PATTERN"):
        return plain_names(sorted(services.params.client.params, key=natural_key))
    return list(NAMES.get(kind, ()))
