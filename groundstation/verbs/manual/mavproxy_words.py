"""Words of MAVProxy, and words that are nearly a verb: what to write here."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

_OVERRIDE = (
    "refused: a vehicle may hold an override for seconds after its sender has died; drive with the keys of the screen, "
    "or use `groundstation drive`, which ends with neutral"
)
_SCREEN = "`groundstation` without a verb opens the screen"

WORDS: Mapping[str, str] = {
    "wp": "use `groundstation mission`", "rc": _OVERRIDE, "rtl": "use `groundstation home`",
    "module": "there are no modules: docs/commands.md lists the verbs", "link": "use `groundstation links`",
    "output": "the program `bridge` forwards to other ground stations", "guided": "use `groundstation goto LAT LON`",
    "setspeed": "use `groundstation speed M/S`", "long": "use `groundstation command`",
    "command_long": "use `groundstation command`", "command_int": "use `groundstation command`, or `goto`",
    "auto": "use `groundstation mode AUTO`", "manual": "use `groundstation mode MANUAL`",
    "hold": "use `groundstation stop`", "loiter": "use `groundstation mode LOITER`",
    "steering": "use `groundstation mode STEERING`", "bat": "use `groundstation status`",
    "gps": "use `groundstation status`", "servo": "use `groundstation command DO_SET_SERVO N US`",
    "relay": "use `groundstation command DO_SET_RELAY N 0|1`", "set": "settings are in a file: `groundstation config`",
    "version": "use `groundstation request AUTOPILOT_VERSION`", "time": "use `groundstation ping`",
    "timesync": "use `groundstation ping`", "map": _SCREEN, "console": _SCREEN, "graph": _SCREEN,
    "signing": "use `groundstation sign`",
    "messagerate": "use `groundstation rate MESSAGE HZ`",
}  # fmt: skip
"""Word -> what to use here."""

ACTIONS: Mapping[tuple[str, str], str] = {
    ("wp", "list"): "use `groundstation mission show`", ("wp", "load"): "use `groundstation mission put FILE`",
    ("wp", "save"): "use `groundstation mission get FILE`", ("wp", "clear"): "use `groundstation mission clear`",
    ("wp", "set"): "use `groundstation mission jump N`",
    ("arm", "throttle"): "use `groundstation arm`", ("arm", "list"): "use `groundstation param get ARMING_CHECK`",
    ("arm", "check"): "use `groundstation command RUN_PREARM_CHECKS`",
    ("param", "fetch"): "use `groundstation param get`", ("param", "show"): "use `groundstation param get`",
    ("fence", "load"): "use `groundstation fence put FILE`", ("fence", "list"): "use `groundstation fence show`",
    ("fence", "save"): "use `groundstation fence get FILE`",
    ("fence", "enable"): "use `groundstation fence on`",
    ("fence", "disable"): "use `groundstation fence off`",
    ("rally", "load"): "use `groundstation rally put FILE`", ("rally", "list"): "use `groundstation rally show`",
    ("rally", "save"): "use `groundstation rally get FILE`", ("log", "download"): "use `groundstation log get ID`",
    ("ftp", "list"): "use `groundstation ftp ls FOLDER`",
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
    return f"{word!r} is neither a verb nor an endpoint: did you mean `groundstation {near[0]}`?" if near else None
