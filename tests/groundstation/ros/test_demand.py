"""Twist and words of /command as Axes."""

import math

import pytest

from dialects.axes import NEUTRAL, Axes
from groundstation.ros.demand import WORDS, RefusedDemandError, Scale


def test_twist_scales_with_full_speed_and_turns_left_if_positive() -> None:
    scale = Scale(speed=2.0, turn=4.0)
    assert scale.of_twist((1.0, 3.0, 3.0), 1.0) == Axes(0.5, -0.25)
    assert scale.of_twist((-0.5, 0.0, 0.0), -4.0) == Axes(-0.25, 1.0)
    assert scale.of_twist((0.0, 0.0, 0.0), 0.0) == NEUTRAL


def test_a_twist_beyond_full_deflection_is_full_deflection() -> None:
    assert Scale(speed=0.5, turn=0.5).of_twist((1e300, math.nan, 0.0), -1e300) == Axes(1.0, 1.0)


def test_a_twist_of_what_flies_has_sideways_and_climb() -> None:
    scale = Scale(speed=2.0, turn=4.0, climb=0.5, flies=True)
    assert scale.of_twist((0.0, 1.0, -0.25), 0.0) == Axes(side=-0.5, climb=-0.5)
    assert scale.of_twist((0.0, -9.0, 9.0), 0.0) == Axes(side=1.0, climb=1.0)
    with pytest.raises(RefusedDemandError, match=r"linear\.z nan.*not finite"):
        scale.of_twist((0.0, 0.0, math.nan), 0.0)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_twist_that_is_not_finite_is_refused(value: float) -> None:
    with pytest.raises(RefusedDemandError, match="not finite"):
        Scale().of_twist((value, 0.0, 0.0), 0.0)
    with pytest.raises(RefusedDemandError, match="not finite"):
        Scale().of_twist((0.0, 0.0, 0.0), value)


@pytest.mark.parametrize(
    ("data", "axes"),
    [
        ("forward", Axes(0.6, 0.0)),
        ("backward", Axes(-0.6, 0.0)),
        ("left", Axes(0.0, -0.4)),
        ("right", Axes(0.0, 0.4)),
        ("stop", NEUTRAL),
        ("i", Axes(0.6, 0.0)),
        (",", Axes(-0.6, 0.0)),
        ("j", Axes(0.0, -0.4)),
        ("l", Axes(0.0, 0.4)),
        ("k", NEUTRAL),
        (" Forward\n", Axes(0.6, 0.0)),
    ],
)
def test_words_and_keys_of_the_article(data: str, axes: Axes) -> None:
    assert Scale().of_word(data) == axes


@pytest.mark.parametrize("data", ["", " ", "auto", "forwards", "\x00", "i" * 1_000_000])
def test_an_unknown_word_is_refused_in_one_short_line(data: str) -> None:
    with pytest.raises(RefusedDemandError) as error:
        Scale().of_word(data)
    assert len(str(error.value)) < 140
    assert "\n" not in str(error.value)


def test_every_word_has_a_key_that_does_the_same() -> None:
    pairs = {"forward": "i", "backward": ",", "left": "j", "right": "l", "stop": "k"}
    assert {word: WORDS[key] for word, key in pairs.items()} == {word: WORDS[word] for word in pairs}
