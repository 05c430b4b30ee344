"""Requests end once, and a refusal has the vehicle's own words if they come within a second."""

from __future__ import annotations

import pytest

from dialects.enums import ParamErrorCode, Severity
from groundstation.vehicles.requests.requests import MAX_REQUESTS, RequestBook, RequestReport, RequestState

WARNING = Severity.WARNING


def ended(book: RequestBook) -> list[RequestReport]:
    return [report for report in book.pop_changes() if report.state.ended]


@pytest.mark.parametrize("said", [9.5, 10.0, 10.9])
def test_a_text_before_or_behind_a_refusal_explains_it(said: float) -> None:
    book = RequestBook()
    book.begin(1, "set A to 2")
    for tenth in range(80, 130):
        now = tenth / 10
        if now == said:
            book.handle_text("A not changed: disarm first", WARNING, now)
        if now == 10.0:
            book.refuse(1, "permission denied", now)
        book.tick(now)
    [report] = ended(book)
    assert report.text == 'set A to 2: refused, permission denied, "A not changed: disarm first"'


@pytest.mark.parametrize(("said", "severity"), [(8.9, WARNING), (11.1, WARNING), (10.0, Severity.DEBUG)])
def test_an_old_or_harmless_text_explains_nothing(said: float, severity: int) -> None:
    book = RequestBook()
    book.begin(1, "set A to 2")
    for tenth in range(80, 130):
        now = tenth / 10
        if now == said:
            book.handle_text("Battery low", severity, now)
        if now == 10.0:
            book.refuse(1, "permission denied", now)
        book.tick(now)
    [report] = ended(book)
    assert report.reason == ""


NOTICE, INFO = Severity.NOTICE, Severity.INFO


@pytest.mark.parametrize(
    ("texts", "reason"),
    [
        (
            [("No Mission. Can't set AUTO.", NOTICE), ("Flight mode change failed", WARNING)],
            "No Mission. Can't set AUTO.; Flight mode change failed",
        ),
        ([("Requested rate for message ID 30 too fast", INFO)], "Requested rate for message ID 30 too fast"),
        ([("EKF3 IMU0 is using GPS", INFO), ("Arm: Compass", WARNING), ("Arm: Compass", WARNING)], "Arm: Compass"),
    ],
    ids=["ArduPilot: AUTO without a mission", "ArduPilot: a rate", "information beside a warning"],
)
@pytest.mark.parametrize("before", [True, False], ids=["texts first", "refusal first"])
def test_the_reason_may_be_no_warning(texts: list[tuple[str, int]], reason: str, *, before: bool) -> None:
    book = RequestBook()
    book.begin(1, "mode AUTO")
    if not before:
        book.refuse(1, "FAILED", 10.0)
    for text, severity in texts:
        book.handle_text(text, severity, 10.1)
    if before:
        book.refuse(1, "FAILED", 10.2)
    for tenth in range(100, 120):
        book.tick(tenth / 10)
    [report] = ended(book)
    assert report.text == f'mode AUTO: refused, FAILED, "{reason}"'


def test_a_text_from_before_the_request_explains_nothing() -> None:
    book = RequestBook()
    book.handle_text("Calibration done", NOTICE, 9.8)
    book.begin(1, "x")
    book.refuse(1, "DENIED", 10.0)
    book.tick(11.0)
    assert [report.reason for report in ended(book)] == [""]


def test_a_request_runs_until_its_reason_is_waited_for() -> None:
    book = RequestBook()
    book.begin(1, "x")
    book.refuse(1, "no", 10.0)
    book.tick(10.9)
    assert ended(book) == []
    assert len(book.running) == 1
    book.tick(11.0)
    assert [report.state for report in ended(book)] == [RequestState.REFUSED]


def test_our_own_refusal_ends_at_once() -> None:
    book = RequestBook()
    book.begin(1, "x")
    book.refuse(1, "no such file", 10.0, by_vehicle=False)
    assert [report.text for report in ended(book)] == ["x: refused, no such file"]


def test_a_refusal_keeps_the_number_of_the_answer() -> None:
    book = RequestBook()
    for number, by_vehicle in ((1, True), (2, False)):
        book.begin(number, "read A")
        book.refuse(number, "no such parameter", 10.0, by_vehicle=by_vehicle, answer=ParamErrorCode.DOES_NOT_EXIST)
    book.begin(3, "read B")
    book.accept(3)
    book.tick(20.0)
    answers = {report.number: report.answer for report in ended(book)}
    assert answers == {1: ParamErrorCode.DOES_NOT_EXIST, 2: ParamErrorCode.DOES_NOT_EXIST, 3: None}


def test_each_request_ends_once() -> None:
    book = RequestBook()
    book.begin(1, "x")
    book.advance(1, 3, 10)
    assert [(report.done, report.total) for report in book.pop_changes()] == [(3, 10)]
    book.accept(1, "10 items")
    book.fail(1, "after 3 tries")
    book.cancel(1)
    book.advance(1, 4, 10)
    assert [report.text for report in book.pop_changes()] == ["x: accepted, 10 items"]


def test_a_number_in_use_is_refused_and_the_first_goes_on() -> None:
    book = RequestBook()
    assert book.begin(1, "first")
    assert not book.begin(1, "second")
    assert [report.what for report in book.running] == ["first"]
    assert [report.text for report in ended(book)] == ["second: refused, its number is in use"]


def test_the_number_of_requests_is_bounded() -> None:
    book = RequestBook()
    assert all(book.begin(number, "x") for number in range(MAX_REQUESTS))
    assert not book.begin(MAX_REQUESTS, "x")
