"""`groundstation completion`: a script for a shell that completes verbs, actions, options and names.

It is made from the table of verbs. Names of parameters, modes and vehicles come from a station that runs, by
`groundstation completion --names`, which opens no link; without a station there are the names of usual modes. zsh runs
the script of bash by its own bashcompinit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from dialects import rover
from dialects.enums import Autopilot, Command, VehicleType
from dialects.messages import MESSAGES
from dialects.modes import known_modes
from groundstation.station_socket.names import MODES, PARAMS, VEHICLES
from groundstation.verbs.shells import SHELLS
from groundstation.verbs.table import ONLY, VERBS, VerbAction

LOCAL_COMMON = ("--dialect", "--json", "--quiet", "--help")
"""Options of all verbs, also of those without a vehicle."""
COMMON = ("--endpoint", "--config", "--vehicle", "--wait", "--station", "--timeout", "--system", *LOCAL_COMMON)
"""Options of all verbs with a vehicle."""
MANY = ("--all", "--group")
"""Options of those that may be for many vehicles."""

_BASH = """\
# completion of groundstation for bash: eval "$(groundstation completion bash)"
_groundstation() {
    local current=${COMP_WORDS[COMP_CWORD]} words="" options="--help" usual="" names=""
    if ((COMP_CWORD == 1)); then
        COMPREPLY=($(compgen -W "@VERBS@" -- "$current"))
        return
    fi
    case "${COMP_WORDS[1]}" in
@CASES@
    esac
    case "${COMP_WORDS[COMP_CWORD - 1]}" in
@VALUES@
    esac
    if [[ $current == -* ]]; then
        words=$options
    elif [[ -n $names ]]; then
        names=$("${COMP_WORDS[0]}" completion --names "$names" 2> /dev/null) || names=$usual
        words+=" $names"
    fi
    COMPREPLY=($(compgen -W "$words" -- "$current"))
}
complete -o default -F _groundstation groundstation
"""
"""Where it proposes nothing, the shell proposes files (-o default)."""
_ZSH = """\
# completion of groundstation for zsh: eval "$(groundstation completion zsh)"
(( $+functions[compdef] )) || { autoload -U +X compinit && compinit }
autoload -U +X bashcompinit && bashcompinit
"""


def build_script(shell: str, helps: Mapping[str, str]) -> str:
    """Return the script. `helps`: verb -> what it does, also of verbs without a vehicle."""
    if shell == "fish":
        return "\n".join(_fish_lines(helps)) + "\n"
    parts = {
        "@VERBS@": " ".join(helps),
        "@CASES@": "\n".join(_bash_cases(helps)),
        "@VALUES@": "\n".join(_bash_values()),
    }
    bash = _BASH
    for mark, part in parts.items():
        bash = bash.replace(mark, part)
    return bash if shell == "bash" else _ZSH + bash


def _bash_cases(helps: Mapping[str, str]) -> Iterator[str]:
    """Yield one case for each verb, inside it one for each action."""
    for verb in helps:
        actions = VERBS.get(verb)
        if actions is None:
            if verb in LOCAL:
                yield f'        {verb}) words="{" ".join(LOCAL[verb])}" ;;'
        elif ONLY in actions:
            yield f"        {verb}) {_assignments(verb, actions[ONLY])} ;;"
        else:
            yield f"        {verb})"
            yield f'            if ((COMP_CWORD == 2)); then words="{" ".join(actions)}"; else'
            yield '                case "${COMP_WORDS[2]}" in'
            for name, action in actions.items():
                yield f"                    {name}) {_assignments(verb, action)} ;;"
            yield "                esac"
            yield "            fi ;;"


def _bash_values() -> Iterator[str]:
    """Yield one case for each option whose values are known. Behind others that take a value, files are proposed."""
    yield '        -v | --vehicle) names=vehicles words="" usual="" ;;'
    for option, values in _OPTION_VALUES.items():
        yield f'        {option}) names="" words="{" ".join(values)}" ;;'
    yield f'        {" | ".join(sorted(_FREE_VALUES))}) names="" words="" ;;'


def _assignments(verb: str, action: VerbAction) -> str:
    """Return what bash shall know of an action: its words, the names to ask a station for, and their substitute."""
    kind = _station_names(verb, action)
    words = " ".join(_words(action)) if _positionals(action) else "$options"
    text = f'options="{" ".join(_options(action))}" words="{words}"'
    return f'{text} names={kind} usual="{" ".join(USUAL.get(kind, ()))}"' if kind else text


def _station_names(verb: str, action: VerbAction) -> str:
    """Return the kind of names that a station knows for the first argument of an action; empty: none."""
    first = next(iter(_positionals(action)), {})
    return STATION_NAMES.get((verb, str(first.get("metavar", ""))), "")


def _fish_lines(helps: Mapping[str, str]) -> Iterator[str]:
    yield "# completion of groundstation for fish: groundstation completion fish | source"
    yield "complete -c groundstation -f"
    yield f"complete -c groundstation -s v -l vehicle -x -a {_quote(_fish_names(VEHICLES))}"
    for verb, text in helps.items():
        yield f"complete -c groundstation -n __fish_use_subcommand -a {verb} -d {_quote(text)}"
        chosen = f"__fish_seen_subcommand_from {verb}"
        if verb in LOCAL:
            yield f"complete -c groundstation -n {_quote(chosen)} -a {_quote(' '.join(LOCAL[verb]))}"
        elif verb not in VERBS:
            yield f"complete -c groundstation -n {_quote(chosen)} -F"
        actions = VERBS.get(verb, {})
        for name, action in actions.items():
            if name != ONLY:
                first = f"{chosen}; and not __fish_seen_subcommand_from {' '.join(actions)}"
                yield f"complete -c groundstation -n {_quote(first)} -a {name} -d {_quote(action.help)}"
            yield from _fish_action(verb, name, action)


def _fish_action(verb: str, name: str, action: VerbAction) -> Iterator[str]:
    """Yield what fish shall propose behind a verb and its action."""
    both = f"__fish_seen_subcommand_from {verb}" + (f"; and __fish_seen_subcommand_from {name}" if name else "")
    start = f"complete -c groundstation -n {_quote(both)}"
    if kind := _station_names(verb, action):
        yield f"{start} -a {_quote(_fish_names(kind))}"
    if words := _words(action):
        yield f"{start} -a {_quote(' '.join(words))}"
    if any(is_file(settings) for settings in _positionals(action)):
        yield f"{start} -F"
    for option in _options(action):
        if option == "--vehicle":
            continue  # that of all verbs
        values = _OPTION_VALUES.get(option)
        needs = f" -x -a {_quote(' '.join(values))}" if values else _FREE_VALUES.get(option, "")
        yield f"{start} -l {option[2:]}{needs}"


def _fish_names(kind: str) -> str:
    usual = " ".join(USUAL.get(kind, ()))
    return f"(groundstation completion --names {kind} 2> /dev/null; or string split ' ' '{usual}')"


def _options(action: VerbAction) -> list[str]:
    """Return the options of an action."""
    own = [name for name, _ in action.arguments if name.startswith("--")]
    return [*own, *(LOCAL_COMMON if action.offline else COMMON), *(MANY if action.many else ())]


def _positionals(action: VerbAction) -> list[dict[str, Any]]:
    """Return the settings of the arguments of an action that are no options."""
    return [settings for name, settings in action.arguments if not name.startswith("-")]


def _words(action: VerbAction) -> list[str]:
    """Return the words that the arguments of an action may be, as far as they are known without a vehicle."""
    return [word for settings in _positionals(action) for word in _values(settings)]


def _values(settings: Mapping[str, Any]) -> Sequence[str]:
    return settings.get("choices") or NAMES.get(str(settings.get("metavar", "")), ())


def is_file(settings: Mapping[str, Any]) -> bool:
    """Return whether an argument is a file here, by what its help calls it."""
    return str(settings.get("metavar", "")).startswith(("FILE", "OUT")) and "=" not in settings["metavar"]


def _quote(text: str) -> str:
    """Return a text in single quotes, as fish reads them."""
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


_MODES = [known_modes(autopilot, VehicleType.GROUND_ROVER) for autopilot in (Autopilot.ARDUPILOT, Autopilot.PX4)]
_MESSAGES = sorted(message.msgname for message in MESSAGES.values())
USUAL: Mapping[str, Sequence[str]] = {MODES: sorted({name for modes in _MODES for name in modes})}
"""Kind of names of a station -> those to propose without one."""
STATION_NAMES: Mapping[tuple[str, str], str] = {
    ("mode", "MODE"): MODES,
    ("param", "NAME"): PARAMS,
    ("param", "PATTERN"): PARAMS,
}
"""Verb, and what an argument is called in its help -> the kind of names that a station knows for it."""
NAMES: Mapping[str, Sequence[str]] = {
    "MESSAGE": _MESSAGES,
    "MESSAGE[.FIELD]": _MESSAGES,
    "MAV_CMD_X": sorted(
        {command.name for command in Command}
        | {entry.name.removeprefix("MAV_CMD_") for entry in rover.enums["MAV_CMD"].values()}
    ),
}
"""What an argument is called in the help -> words that it may be."""
LOCAL: Mapping[str, Sequence[str]] = {"config": ("check", "show", "init", "path"), "completion": SHELLS}
"""Actions of verbs without a vehicle."""
_FILE_OPTIONS = {"--config": {"metavar": "FILE"}, "--dialect": {"metavar": "FILE"}}
_OTHER_OPTIONS = {
    option: {"metavar": "S"} for option in ("-e", "--endpoint", "--group", "--wait", "--timeout", "--system")
}
_OWN_OPTIONS = {
    name: settings
    for actions in VERBS.values()
    for action in actions.values()
    for name, settings in action.arguments
    if name.startswith("--") and settings.get("action") != "store_true"
}
_OPTION_VALUES: Mapping[str, Sequence[str]] = {
    "--station": ("auto", "only", "never"),
    **{name: settings["choices"] for name, settings in _OWN_OPTIONS.items() if "choices" in settings},
}
"""Option -> its values, where they are known."""
_FREE_VALUES = {
    name: " -r -F" if is_file(settings) else " -x"
    for name, settings in {**_FILE_OPTIONS, **_OTHER_OPTIONS, **_OWN_OPTIONS}.items()
    if name not in _OPTION_VALUES
}
"""Option with another value -> what fish shall know of it: files are proposed, or nothing."""
