"""The age of a picture, in virtual time: fresh, late, frozen, fresh again."""

from __future__ import annotations

from groundstation.pictures.freshness import OLD_AFTER, Freshness, PictureAge, PictureState
from groundstation.pictures.picture import Picture

ONE, OTHER = (Picture(1, 1, bytes([value, 0, 0])) for value in (1, 2))


def test_a_picture_is_fresh_late_frozen_and_fresh_again() -> None:
    age = PictureAge()
    assert age.judge(100.0) == PictureState(Freshness.NONE)
    assert age.note(ONE, 100.0)
    assert age.judge(100.0 + OLD_AFTER) == PictureState(Freshness.FRESH, OLD_AFTER)
    assert age.judge(100.75) == PictureState(Freshness.LATE, 0.75)
    for tenth in range(8, 20):  # it comes, and is the same
        assert not age.note(ONE, 100.0 + tenth / 10)
    assert age.judge(102.0) == PictureState(Freshness.FROZEN, 2.0)
    assert age.judge(103.0) == PictureState(Freshness.LATE, 3.0)
    assert age.note(OTHER, 103.0)
    assert age.judge(103.25).fresh


def test_a_copy_never_makes_a_picture_fresh() -> None:
    age = PictureAge()
    age.note(ONE, 0.0)
    for number in range(1, 100):
        age.note(Picture(1, 1, bytes(ONE.rgb)), number / 10)
        assert age.judge(number / 10).fresh is (number / 10 <= OLD_AFTER)
