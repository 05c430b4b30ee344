"""Words of MAVProxy, and words that are nearly a verb: what to write here.

Those for which a verb is the answer are in the row of the verb (Verb.mavproxy).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from groundstation.verbs.verb import Verb

_SCREEN = "`mavhelm` without a verb opens the screen"

WORDS: Mapping[str, str] = {
    "rc": "refused: a vehicle may hold an override for seconds after its sender has died; drive with the keys of the "
    "screen, or use `mavhelm drive`, which ends with neutral",
    "module": "there are no modules: docs/commands.md lists the verbs",
    "output": "the program `mavhelm bridge` forwards to other ground stations",
    "command_int": "use `mavhelm command`, or `goto`",
    "plan": "use `mavhelm mission put FILE`, `fence put` or `rally put`",
    "set": "settings are in a file: `mavhelm config`",
    "map": _SCREEN, "console": _SCREEN, "graph": _SCREEN,
}  # fmt: skip
"""Word -> what to use here, where that is more than one verb or none."""


def describe_action(arguments: Sequence[str], verbs: Mapping[str, Verb]) -> str | None:
    """Return one line for an action of MAVProxy that a verb of the same name does not have, or None."""
    return _describe(" ".join(arguments[:2]), verbs) if len(arguments) > 1 else None


def describe_word(word: str, verbs: Mapping[str, Verb]) -> str | None:
    """Return one line for a word that is neither a verb nor an endpoint, or None."""
    if word in WORDS:
        return f"{word}: {WORDS[word]}"
    if hint := _describe(word, verbs):
        return hint
    import difflib  # 6 ms that a known verb does without

    near = difflib.get_close_matches(word, verbs, n=1, cutoff=0.7)
    return f"{word!r} is neither a verb nor an endpoint: did you mean `mavhelm {near[0]}`?" if near else None


def _describe(words: str, verbs: Mapping[str, Verb]) -> str | None:
    answer = next((verb.mavproxy[words] for verb in verbs.values() if words in verb.mavproxy), None)
    return f"{words}: use `mavhelm {answer}`" if answer else None
