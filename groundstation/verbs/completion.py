"""`groundstation completion`: a script for a shell that completes verbs, actions, options and names.

It is made from the table of verbs, and asks no vehicle. zsh runs the script of bash by its own bashcompinit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from dialects import rover
from dialects.enums import Autopilot, Command, VehicleType
from dialects.messages import MESSAGES
from dialects.modes import known_modes
from groundstation.verbs.arguments import Argument
from groundstation.verbs.table import ONLY, VERBS, VerbAction

COMMON = (
    "--endpoint", "--config", "--vehicle", "--wait", "--timeout", "--system", "--dialect", "--json", "--quiet",
    "--help",
)  # fmt: skip
"""Options of all verbs."""
SHELLS = ("bash", "zsh", "fish")

_BASH = """\
# completion of groundstation for bash: eval "$(groundstation completion bash)"
_groundstation() {
    local current=${COMP_WORDS[COMP_CWORD]} words=""
    if ((COMP_CWORD == 1)); then
        COMPREPLY=($(compgen -W "@VERBS@" -- "$current"))
        return
    fi
    case "${COMP_WORDS[1]}" in
@CASES@
    esac
    COMPREPLY=($(compgen -W "$words" -- "$current"))
    if ((${#COMPREPLY[@]} == 0)) && [[ $current != -* ]]; then
        COMPREPLY=($(compgen -f -- "$current"))
    fi
}
complete -o filenames -F _groundstation groundstation
"""
_ZSH = """\
# completion of groundstation for zsh: eval "$(groundstation completion zsh)"
autoload -U +X bashcompinit && bashcompinit
"""


def build_script(shell: str, helps: Mapping[str, str]) -> str:
    """Return the script. `helps`: verb -> what it does, also of verbs without a vehicle."""
    if shell == "fish":
        return "\n".join(_fish_lines(helps)) + "\n"
    cases = "\n".join(_bash_cases(helps))
    bash = _BASH.replace("@VERBS@", " ".join(helps)).replace("@CASES@", cases)
    return bash if shell == "bash" else _ZSH + bash


def _bash_cases(helps: Mapping[str, str]) -> Iterator[str]:
    """Yield one case for each verb, inside it one for each action."""
    for verb in helps:
        actions = VERBS.get(verb)
        if actions is None:
            yield f'        {verb}) words="{" ".join(LOCAL.get(verb, ()))} --help" ;;'
        elif ONLY in actions:
            yield f'        {verb}) words="{_words(actions[ONLY])}" ;;'
        else:
            yield f"        {verb})"
            yield f'            if ((COMP_CWORD == 2)); then words="{" ".join(actions)}"; else'
            yield '                case "${COMP_WORDS[2]}" in'
            for name, action in actions.items():
                yield f'                    {name}) words="{_words(action)}" ;;'
            yield "                esac"
            yield "            fi ;;"


def _fish_lines(helps: Mapping[str, str]) -> Iterator[str]:
    yield "# completion of groundstation for fish: groundstation completion fish | source"
    for verb, text in helps.items():
        yield f"complete -c groundstation -n __fish_use_subcommand -a {verb} -d {_quote(text)}"
        for name, action in VERBS.get(verb, {}).items():
            chosen = f"__fish_seen_subcommand_from {verb}"
            if name != ONLY:
                yield f"complete -c groundstation -n {_quote(chosen)} -a {name} -d {_quote(action.help)}"
                chosen += f"; and __fish_seen_subcommand_from {name}"
            for word in _words(action).split():
                option = f"-l {word[2:]}" if word.startswith("--") else f"-a {word}"
                yield f"complete -c groundstation -n {_quote(chosen)} {option}"


def _words(action: VerbAction) -> str:
    """Return the options of an action and the names that its arguments may have."""
    own = [name for name, _ in action.arguments if name.startswith("--")]
    names = [name for argument in action.arguments for name in _names(argument)]
    return " ".join([*names, *own, *COMMON])


def _names(argument: Argument) -> Sequence[str]:
    """Return the words that a positional argument may be, as far as they are known without a vehicle."""
    name, settings = argument
    return () if name.startswith("-") else NAMES.get(str(settings.get("metavar", "")), ())


def _quote(text: str) -> str:
    """Return a text in single quotes, as fish reads them."""
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


_MODES = [known_modes(autopilot, VehicleType.GROUND_ROVER) for autopilot in (Autopilot.ARDUPILOT, Autopilot.PX4)]
_MESSAGES = sorted(message.msgname for message in MESSAGES.values())
NAMES: Mapping[str, Sequence[str]] = {
    "MESSAGE": _MESSAGES,
    "MESSAGE[.FIELD]": _MESSAGES,
    "MODE": sorted({name for modes in _MODES for name in modes}),
    "MAV_CMD_X": sorted(
        {command.name for command in Command}
        | {entry.name.removeprefix("MAV_CMD_") for entry in rover.enums["MAV_CMD"].values()}
    ),
}
"""What an argument is called in the help -> words that it may be."""
LOCAL: Mapping[str, Sequence[str]] = {"config": ("check", "show", "init", "path"), "completion": SHELLS}
"""Actions of verbs without a vehicle."""
