"""Questions: `y` or a word, in time; any other key means no."""

from __future__ import annotations

from groundstation.ui.base.question import ANSWER_WITHIN, Question


class Asked:
    """A question and how often it was answered with yes."""

    def __init__(self, word: str = "") -> None:
        self.performed = 0
        self.question = Question(lambda: "erase all logs", self._perform, word, until=ANSWER_WITHIN)

    def _perform(self) -> None:
        self.performed += 1


def test_y_performs_the_action_once() -> None:
    asked = Asked()
    assert asked.question.hint == "erase all logs · y does it, any other key not"
    assert not asked.question.answer("y", 1.0)
    assert asked.performed == 1


def test_any_other_key_and_an_answer_too_late_mean_no() -> None:
    for key, now in (("n", 1.0), ("Y", 1.0), ("enter", 1.0), ("y", ANSWER_WITHIN)):
        asked = Asked()
        assert not asked.question.answer(key, now)
        assert asked.performed == 0


def test_a_word_is_typed_letter_by_letter() -> None:
    asked = Asked("erase")
    assert all(asked.question.answer(key, now) for now, key in enumerate("eras"))
    assert asked.question.hint == "erase all logs · type erase: eras_"
    assert asked.performed == 0
    assert not asked.question.answer("e", 5.0)
    assert asked.performed == 1


def test_a_wrong_letter_means_no() -> None:
    asked = Asked("erase")
    assert asked.question.answer("e", 1.0)
    assert not asked.question.answer("y", 1.0)
    assert asked.performed == 0


def test_each_letter_has_its_time() -> None:
    asked = Asked("erase")
    assert asked.question.answer("e", ANSWER_WITHIN - 1)
    assert asked.question.answer("r", 2 * ANSWER_WITHIN - 2)
    assert not asked.question.answer("a", 3 * ANSWER_WITHIN)
