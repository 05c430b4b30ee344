"""Words of MAVProxy, and words that are nearly a verb: what to write here."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

_OVERRIDE = (
    "refused: a vehicle may hold an override for seconds after its sender has died; drive with the keys of the screen, "
    "or use `mavhelm drive`, which ends with neutral"
)
_SCREEN = "`mavhelm` without a verb opens the screen"

WORDS: Mapping[str, str] = {
    "wp": "use `mavhelm mission`", "rc": _OVERRIDE, "rtl": "use `mavhelm home`",
    "module": "there are no modules: docs/commands.md lists the verbs", "link": "use `mavhelm links`",
    "output": "the program `mavhelm bridge` forwards to other ground stations", "guided": "use `mavhelm goto LAT LON`",
    "setspeed": "use `mavhelm speed M/S`", "long": "use `mavhelm command`",
    "command_long": "use `mavhelm command`", "command_int": "use `mavhelm command`, or `goto`",
    "auto": "use `mavhelm mode AUTO`", "manual": "use `mavhelm mode MANUAL`",
    "hold": "use `mavhelm stop`", "loiter": "use `mavhelm mode LOITER`",
    "steering": "use `mavhelm mode STEERING`", "bat": "use `mavhelm status`",
    "gps": "use `mavhelm status`", "servo": "use `mavhelm command DO_SET_SERVO N US`",
    "relay": "use `mavhelm command DO_SET_RELAY N 0|1`", "set": "settings are in a file: `mavhelm config`",
    "version": "use `mavhelm request AUTOPILOT_VERSION`", "time": "use `mavhelm ping`",
    "timesync": "use `mavhelm ping`", "map": _SCREEN, "console": _SCREEN, "graph": _SCREEN,
    "signing": "use `mavhelm sign`",
    "messagerate": "use `mavhelm rate MESSAGE HZ`",
}  # fmt: skip
"""Word -> what to use here."""

ACTIONS: Mapping[tuple[str, str], str] = {
    ("wp", "list"): "use `mavhelm mission show`", ("wp", "load"): "use `mavhelm mission put FILE`",
    ("wp", "save"): "use `mavhelm mission get FILE`", ("wp", "clear"): "use `mavhelm mission clear`",
    ("wp", "set"): "use `mavhelm mission jump N`",
    ("arm", "throttle"): "use `mavhelm arm`", ("arm", "list"): "use `mavhelm param get ARMING_CHECK`",
    ("arm", "check"): "use `mavhelm command RUN_PREARM_CHECKS`",
    ("param", "fetch"): "use `mavhelm param get`", ("param", "show"): "use `mavhelm param get`",
    ("fence", "load"): "use `mavhelm fence put FILE`", ("fence", "list"): "use `mavhelm fence show`",
    ("fence", "save"): "use `mavhelm fence get FILE`",
    ("fence", "enable"): "use `mavhelm fence on`",
    ("fence", "disable"): "use `mavhelm fence off`",
    ("rally", "load"): "use `mavhelm rally put FILE`", ("rally", "list"): "use `mavhelm rally show`",
    ("rally", "save"): "use `mavhelm rally get FILE`", ("log", "download"): "use `mavhelm log get ID`",
    ("ftp", "list"): "use `mavhelm ftp ls FOLDER`",
}  # fmt: skip
"""Two words -> what to use here."""


def describe_action(arguments: Sequence[str]) -> str | None:
    """Return one line for an action of MAVProxy that a verb of the same name does not have, or None."""
    hint = ACTIONS.get((arguments[0], arguments[1])) if len(arguments) > 1 else None
    return f"{' '.join(arguments[:2])}: {hint}" if hint else None


def describe_word(word: str, verbs: Collection[str]) -> str | None:
    """Return one line for a word that is neither a verb nor an endpoint, or None."""
    if word in WORDS:
        return f"{word}: {WORDS[word]}"
    import difflib  # 6 ms that a known verb does without

    near = difflib.get_close_matches(word, verbs, n=1, cutoff=0.7)
    return f"{word!r} is neither a verb nor an endpoint: did you mean `mavhelm {near[0]}`?" if near else None
