"""`mavhelm completion`: a script for a shell that completes verbs, actions, options and names.

It is made from the table of verbs. Names of parameters, modes and vehicles come from a station that runs, by
`mavhelm completion --names`, which opens no link; without a station there are the names of usual modes. bash and
zsh share the rules that say what is proposed where. No shell expands a name of a vehicle, and one that is no PLAIN_NAME
is left out twice, by the program and by the script.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from dialects import rover
from dialects.enums import Autopilot, Command, VehicleType
from dialects.kinds import find_kind
from dialects.messages import MESSAGES
from groundstation.station_socket.names import MODES, PARAMS, PLAIN_NAME, VEHICLES
from groundstation.verbs.action import ONLY, VerbAction
from groundstation.verbs.manual.shells import SHELLS
from groundstation.verbs.table import VERBS

LOCAL_COMMON = ("--dialect", "--json", "--quiet", "--help")
"""Options of all verbs, also of those without a vehicle."""
COMMON = ("--endpoint", "--config", "--vehicle", "--wait", "--station", "--timeout", "--system", *LOCAL_COMMON)
"""Options of all verbs with a vehicle."""
MANY = ("--all", "--group")
"""Options of those that may be for many vehicles."""

_BASH = """\
# completion of mavhelm for bash: eval "$(mavhelm completion bash)"
_mavhelm() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
    local verb=${COMP_WORDS[1]} action=${COMP_WORDS[2]} at=$COMP_CWORD
    local known="" options="--help" usual="" names="" word
    local -a proposed=() found=()
    COMPREPLY=()
@RULES@
    IFS=' ' read -r -a proposed <<< "$known"
    if [[ -n $names ]]; then
        mapfile -t found < <("${COMP_WORDS[0]}" completion --names "$names" 2> /dev/null)
        ((${#found[@]})) || IFS=' ' read -r -a found <<< "$usual"
        for word in "${found[@]}"; do
            [[ $word =~ ^@PLAIN@$ ]] && proposed+=("$word")
        done
    fi
    for word in "${proposed[@]}"; do
        [[ ${word:0:${#current}} == "$current" ]] && COMPREPLY+=("$word")
    done
    ((${#COMPREPLY[@]})) && return
    if [[ $current == -* ]]; then
        compopt +o default 2> /dev/null
    elif [[ -z $current ]] && compgen -G '[-~]*' > /dev/null; then
        compopt -o filenames 2> /dev/null
        COMPREPLY=(./*)
    fi
}
complete -o default -F _mavhelm mavhelm groundstation
"""
"""Where it proposes nothing, bash proposes files (-o default). It never expands a name: `compgen -W` would run what
is in it, so that words are compared letter by letter. If a file begins with - or ~, all get ./ before them."""
_ZSH = """\
# completion of mavhelm for zsh: eval "$(mavhelm completion zsh)"
(( $+functions[compdef] )) || { autoload -U +X compinit && compinit }
_mavhelm() {
    local current=$words[CURRENT] previous=$words[CURRENT-1] verb=$words[2] action=$words[3] at=$((CURRENT - 1))
    local known="" options="--help" usual="" names="" word
    local -a proposed=() found=() dashed=()
@RULES@
    proposed=(${=known})
    if [[ -n $names ]]; then
        found=(${(f)"$("${words[1]}" completion --names "$names" 2> /dev/null)"})
        (( $#found )) || found=(${=usual})
        for word in $found; do
            [[ $word =~ "^@PLAIN@$" ]] && proposed+=($word)
        done
    fi
    compadd -a proposed && return
    [[ $current == -* ]] && return 1
    dashed=(-*(N))
    if [[ -z $current ]] && (( $#dashed )); then
        _files -P ./
    else
        _default
    fi
}
compdef _mavhelm mavhelm groundstation
"""


_FISH = """\
# completion of mavhelm for fish: mavhelm completion fish | source
function __mavhelm_dashed # whether a file here would look like an option
    set -l token (commandline -ct)
    set -l found ./-*
    set -q found[1]; and not string match -q '*/*' -- "$token"
end
function __mavhelm_files
    set -l token (commandline -ct)
    complete -C "'' $token" | string match -v -- '-*'
end
complete -c mavhelm -f
complete -c groundstation -w mavhelm
"""
_FISH_FILES = (
    ("; and not __mavhelm_dashed", " -r -F"),
    ("; and __mavhelm_dashed", " -x -a '(__mavhelm_files)'"),
)
"""Conditions, and how files are proposed: without those that begin with -, which fish would propose as they are."""


def build_script(shell: str, helps: Mapping[str, str]) -> str:
    """Return the script. `helps`: verb -> what it does, also of verbs without a vehicle."""
    if shell == "fish":
        return _FISH + "\n".join(_fish_lines(helps)) + "\n"
    script = _BASH if shell == "bash" else _ZSH
    return script.replace("@RULES@", "\n".join(_rules(helps))).replace("@PLAIN@", PLAIN_NAME)


def _rules(helps: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines, for bash and zsh, that set what is proposed at this place of the command line."""
    yield '    case "$verb" in'
    yield from _verb_cases(helps)
    yield "    esac"
    yield '    case "$previous" in'
    yield from _option_cases()
    yield "    esac"
    yield '    if [[ $current == -* ]]; then known=$options names=""; fi'
    yield f'    if ((at == 1)); then known="{" ".join(helps)}" names=""; fi'


def _verb_cases(helps: Mapping[str, str]) -> Iterator[str]:
    """Yield one case for each verb, inside it one for each action."""
    for verb in helps:
        actions = VERBS[verb].actions if verb in VERBS else {}
        if not actions:
            if verb in LOCAL:
                yield f'        {verb}) known="{" ".join(LOCAL[verb])}" ;;'
        elif ONLY in actions:
            yield f"        {verb}) {_assignments(verb, actions[ONLY])} ;;"
        else:
            yield f"        {verb})"
            yield f'            if ((at == 2)); then known="{" ".join(actions)}"; else'
            yield '                case "$action" in'
            for name, action in actions.items():
                yield f"                    {name}) {_assignments(verb, action)} ;;"
            yield "                esac"
            yield "            fi ;;"


def _option_cases() -> Iterator[str]:
    """Yield one case for each option whose values are known. Behind others that take a value, files are proposed."""
    yield '        -v | --vehicle) names=vehicles known="" usual="" ;;'
    for option, values in _OPTION_VALUES.items():
        yield f'        {option}) names="" known="{" ".join(values)}" ;;'
    yield f'        {" | ".join(sorted(_FREE_VALUES))}) names="" known="" ;;'


def _assignments(verb: str, action: VerbAction) -> str:
    """Return what bash shall know of an action: its words, the names to ask a station for, and their substitute."""
    kind = _station_names(verb, action)
    words = " ".join(_words(action)) if _positionals(action) else "$options"
    text = f'options="{" ".join(_options(action))}" known="{words}"'
    return f'{text} names={kind} usual="{" ".join(USUAL.get(kind, ()))}"' if kind else text


def _station_names(verb: str, action: VerbAction) -> str:
    """Return the kind of names that a station knows for the first argument of an action; empty: none."""
    first = next(iter(_positionals(action)), {})
    return STATION_NAMES.get((verb, str(first.get("metavar", ""))), "")


def _fish_lines(helps: Mapping[str, str]) -> Iterator[str]:
    yield f"complete -c mavhelm -s v -l vehicle -x -a {_quote(_fish_names(VEHICLES))}"
    for verb, text in helps.items():
        yield f"complete -c mavhelm -n __fish_use_subcommand -a {verb} -d {_quote(text)}"
        chosen = f"__fish_seen_subcommand_from {verb}"
        if verb in LOCAL:
            yield f"complete -c mavhelm -n {_quote(chosen)} -a {_quote(' '.join(LOCAL[verb]))}"
        elif verb not in VERBS:
            yield from _fish_file(chosen)
        actions = VERBS[verb].actions if verb in VERBS else {}
        for name, action in actions.items():
            if name != ONLY:
                first = f"{chosen}; and not __fish_seen_subcommand_from {' '.join(actions)}"
                yield f"complete -c mavhelm -n {_quote(first)} -a {name} -d {_quote(action.help)}"
            yield from _fish_action(verb, name, action)


def _fish_action(verb: str, name: str, action: VerbAction) -> Iterator[str]:
    """Yield what fish shall propose behind a verb and its action."""
    both = f"__fish_seen_subcommand_from {verb}" + (f"; and __fish_seen_subcommand_from {name}" if name else "")
    start = f"complete -c mavhelm -n {_quote(both)}"
    if kind := _station_names(verb, action):
        yield f"{start} -a {_quote(_fish_names(kind))}"
    if words := _words(action):
        yield f"{start} -a {_quote(' '.join(words))}"
    if any(is_file(settings) for settings in _positionals(action)):
        yield from _fish_file(both)
    for option in _options(action):
        if option == "--vehicle":
            continue  # that of all verbs
        if values := _OPTION_VALUES.get(option):
            yield f"{start} -l {option[2:]} -x -a {_quote(' '.join(values))}"
        elif _FREE_VALUES.get(option):
            yield from _fish_file(both, f" -l {option[2:]}")
        else:
            yield f"{start} -l {option[2:]}{' -x' if option in _FREE_VALUES else ''}"


def _fish_file(condition: str, option: str = "") -> Iterator[str]:
    """Yield what proposes files, as the value of an option or as an argument."""
    for more, files in _FISH_FILES:
        yield f"complete -c mavhelm -n {_quote(condition + more)}{option}{files}"


def _fish_names(kind: str) -> str:
    usual = " ".join(USUAL.get(kind, ()))
    otherwise = f"; or string split ' ' '{usual}'" if usual else ""
    return f"(mavhelm completion --names {kind} 2> /dev/null | string match -r '^{PLAIN_NAME}$'{otherwise})"


def _options(action: VerbAction) -> list[str]:
    """Return the options of an action."""
    own = [name for name, _ in action.arguments if name.startswith("--")]
    return [*own, *(LOCAL_COMMON if action.offline else COMMON), *(MANY if action.many else ())]


def _positionals(action: VerbAction) -> list[dict[str, Any]]:
    """Return the settings of the arguments of an action that are not options."""
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


_MODES = [find_kind(autopilot, VehicleType.GROUND_ROVER).choices for autopilot in (Autopilot.ARDUPILOT, Autopilot.PX4)]
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
LOCAL: Mapping[str, Sequence[str]] = {
    "config": ("check", "show", "init", "path"),
    "completion": SHELLS,
    "vehicle": ("init", "check", "doctor", "schema", "dialect", "motor-test", "key", "safe-stop", "systemd-unit"),
    "bridge": ("doctor", "router", "fleet"),
}
"""Actions of verbs without a vehicle, and subcommands of the other programs."""
_FILE_OPTIONS = {"--config": {"metavar": "FILE"}, "--dialect": {"metavar": "FILE"}}
_OTHER_OPTIONS = {
    option: {"metavar": "S"} for option in ("-e", "--endpoint", "--group", "--wait", "--timeout", "--system")
}
_OWN_OPTIONS = {
    name: settings
    for verb in VERBS.values()
    for action in verb.actions.values()
    for name, settings in action.arguments
    if name.startswith("--") and settings.get("action") != "store_true"
}
_OPTION_VALUES: Mapping[str, Sequence[str]] = {
    "--station": ("auto", "only", "never"),
    **{name: settings["choices"] for name, settings in _OWN_OPTIONS.items() if "choices" in settings},
}
"""Option -> its values, where they are known."""
_FREE_VALUES = {
    name: is_file(settings)
    for name, settings in {**_FILE_OPTIONS, **_OTHER_OPTIONS, **_OWN_OPTIONS}.items()
    if name not in _OPTION_VALUES
}
"""Option with another value -> whether that is a file."""
