"""Words of MAVProxy and slips of the finger in the place of a verb: one line, and what to write here."""

from __future__ import annotations

import re

import pytest

from groundstation.cli.main import main
from groundstation.cli.verb_help import LOCAL_HELP, PROGRAM_HELP, VERB_HELP
from groundstation.verbs.action import ONLY
from groundstation.verbs.manual.mavproxy_words import ACTIONS, WORDS
from groundstation.verbs.table import VERBS

SAID = [
    ("wp list", "use `mavhelm mission show`"),
    ("wp", "use `mavhelm mission`"),
    ("arm throttle", "use `mavhelm arm`"),
    ("param fetch", "use `mavhelm param get`"),
    ("fence load fence.txt", "use `mavhelm fence put FILE`"),
    ("rc 3 1600", "refused: a vehicle may hold an override"),
    ("module load console", "there are no modules"),
    ("statsu", "'statsu' is neither a verb nor an endpoint: did you mean `mavhelm status`?"),
    ("nonsense", "'nonsense' is not an endpoint such as"),
]


@pytest.mark.parametrize(("words", "said"), SAID, ids=[words for words, _ in SAID])
def test_one_line_names_what_to_write(capsys: pytest.CaptureFixture[str], words: str, said: str) -> None:
    assert main(words.split()) == 2
    printed = capsys.readouterr()
    assert (printed.out, len(printed.err.splitlines())) == ("", 1)
    assert said in printed.err


def test_every_verb_that_is_proposed_exists_and_none_is_hidden() -> None:
    for hint in [*WORDS.values(), *ACTIONS.values()]:
        for verb, action in re.findall(r"`mavhelm ([a-z]+)(?: ([a-z]+))?", hint):
            assert verb in VERB_HELP | LOCAL_HELP | PROGRAM_HELP, hint
            assert not action or verb in PROGRAM_HELP or ONLY in VERBS[verb] or action in VERBS[verb], hint
    assert not set(WORDS) & (VERB_HELP | LOCAL_HELP).keys()
    assert not any(action in VERBS.get(verb, {}) for verb, action in ACTIONS)
