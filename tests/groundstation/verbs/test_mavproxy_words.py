"""Words of MAVProxy and slips of the finger in the place of a verb: one line, and what to write here."""

from __future__ import annotations

import re

import pytest

from groundstation.cli.main import main
from groundstation.cli.verb_help import EVERY_VERB, LOCAL_VERBS, PROGRAMS
from groundstation.verbs.action import ONLY
from groundstation.verbs.mavproxy_words import WORDS
from groundstation.verbs.table import VERBS

SAID = [
    ("wp list", "use `mavhelm mission show`"),
    ("wp", "use `mavhelm mission`"),
    ("arm throttle", "use `mavhelm arm`"),
    ("param fetch", "use `mavhelm param get`"),
    ("fence load fence.txt", "use `mavhelm fence put FILE`"),
    ("rc 3 1600", "refused: a vehicle may hold an override"),
    ("plan upload a.plan", "plan: use `mavhelm mission put FILE`"),
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
    of_rows = {words: answer for verb in EVERY_VERB.values() for words, answer in verb.mavproxy.items()}
    assert sum(len(verb.mavproxy) for verb in EVERY_VERB.values()) == len(of_rows) > 40, "no words are in two rows"
    for hint in [*WORDS.values(), *(f"`mavhelm {answer}`" for answer in of_rows.values())]:
        for verb, action in re.findall(r"`mavhelm ([a-z]+)(?: ([a-z]+))?", hint):
            assert verb in EVERY_VERB, hint
            assert not action or verb in PROGRAMS or {ONLY, action} & VERBS[verb].actions.keys(), hint
    words = {*WORDS, *(each for each in of_rows if " " not in each)}
    assert not words & (VERBS | LOCAL_VERBS).keys()
    pairs = [tuple(each.split()) for each in of_rows if " " in each]
    assert not any(verb in VERBS and action in VERBS[verb].actions for verb, action in pairs)
