"""What all command lines have in common."""

from __future__ import annotations

import pytest

from link.runtime.command_line import CommandLineParser


def parser() -> CommandLineParser:
    parser = CommandLineParser(prog="car")
    parser.add_argument("files", nargs="*")
    parser.add_argument("--state")
    return parser


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--state", ""], "car: --state has nothing behind it: give it a value, or leave it out"),
        (["--state="], "car: --state has nothing behind it"),
        (["--state=--"], "car: --state has nothing behind it"),
        (["a", "", "b"], "car: an argument is empty: leave it out"),
        ([""], "car: an argument is empty"),
    ],
)
def test_an_empty_word_is_refused_by_name(words: list[str], says: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        parser().reject_empty(words)
    assert left.value.code == 2
    assert capsys.readouterr().err.startswith(says)


def test_other_words_are_taken_as_they_are() -> None:
    words = ["--state", "x", "a=", "-1", "--"]
    assert parser().reject_empty(words) == words


def test_a_mistake_is_one_line_also_where_its_word_is_several(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parser().parse_args(["--sta\nte", "two\nlines"])
    assert capsys.readouterr().err == "car: unrecognized arguments: --sta te (car --help shows how)\n"


def test_the_choice_that_may_be_meant_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    given = CommandLineParser(prog="car")
    given.add_argument("gear", choices=("first", "second"))
    with pytest.raises(SystemExit):
        given.parse_args(["frist"])
    assert "; did you mean first? (car" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        given.parse_args(["zebra"])
    assert "did you mean" not in capsys.readouterr().err
