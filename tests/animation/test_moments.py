"""Frames of a picture: whole updates of the screen, at most one in a step, pauses cut short."""

from __future__ import annotations

from tests.animation.asciicast import Output
from tests.animation.moments import BEGIN, END, Moment, choose_moments, merge_equal, whole_updates


def test_an_update_in_pieces_is_shown_when_it_ends() -> None:
    outputs = [Output(0.1, "a"), Output(0.2, f"{BEGIN}b"), Output(0.3, "c"), Output(0.4, f"d{END}")]
    assert list(whole_updates(outputs)) == [Output(0.1, "a"), Output(0.4, f"{BEGIN}bcd{END}")]


def test_the_beginning_of_the_next_update_waits_for_its_end() -> None:
    outputs = [Output(0.1, f"{BEGIN}a{END}{BEGIN}b"), Output(0.2, f"c{END}d")]
    assert list(whole_updates(outputs)) == [Output(0.1, f"{BEGIN}a{END}"), Output(0.2, f"{BEGIN}bc{END}d")]


def test_a_mark_that_is_cut_in_two_is_found() -> None:
    outputs = [Output(0.1, f"{BEGIN}a{END[:4]}"), Output(0.2, END[4:])]
    assert list(whole_updates(outputs)) == [Output(0.2, f"{BEGIN}a{END}")]


def test_an_update_without_an_end_is_left_out() -> None:
    assert list(whole_updates([Output(0.1, "a"), Output(0.2, f"{BEGIN}b")])) == [Output(0.1, "a")]


def test_outputs_of_a_step_are_one_frame() -> None:
    outputs = [Output(0.0, "a"), Output(0.4, "b"), Output(0.6, "c"), Output(1.0, "d")]
    assert choose_moments(outputs, step=0.5, longest=9.0, last=2.0) == [
        Moment("ab", 0.5), Moment("c", 0.5), Moment("d", 2.0),
    ]  # fmt: skip


def test_a_long_pause_is_cut_short() -> None:
    moments = choose_moments([Output(0.0, "a"), Output(30.0, "b"), Output(30.5, "c")], step=0.5, longest=1.0, last=2.0)
    assert moments == [Moment("a", 1.0), Moment("b", 0.5), Moment("c", 2.0)]


def test_a_recording_without_output_has_no_frame() -> None:
    assert choose_moments([], step=0.5, longest=1.0, last=2.0) == []


def test_a_picture_like_the_one_before_makes_that_longer() -> None:
    frames = [("a", 0.5), ("a", 0.25), ("b", 1.0), ("a", 0.5)]
    assert merge_equal(frames) == [("a", 0.75), ("b", 1.0), ("a", 0.5)]
