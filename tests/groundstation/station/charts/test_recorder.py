"""Points of fields: bounded memory, pages without holes and doubles, marks, pins."""

from __future__ import annotations

from array import array

from hypothesis import given
from hypothesis import strategies as st

from groundstation.ipc import MAX_PACKET, encode
from groundstation.station.charts.points import CAPACITY, SLOT, SPAN, PointBuffer
from groundstation.station.charts.recorder import PAGE, SeriesRecorder
from groundstation.views.charts import MAX_FIELDS, FieldId, Mark, SeriesPage, SeriesRequest

A, B = FieldId(1, 1, False, "VFR_HUD", "groundspeed"), FieldId(1, 1, False, "ATTITUDE", "yaw")


def points(buffer: PointBuffer, after: int = 0, limit: int = 10**9) -> list[tuple[float, float]]:
    times, values = (array("d", data) for data in buffer.take(after, limit))
    return list(zip(times, values, strict=True))


def counted() -> PointBuffer:
    numbers = iter(range(1, 10**9))
    return PointBuffer(lambda: next(numbers))


def read(page: SeriesPage, field: FieldId) -> list[tuple[float, float]]:
    for each in page.points:
        if each.field == field:
            return list(zip(array("d", each.times), array("d", each.values), strict=True))
    return []


def test_slow_samples_are_kept_whole_and_of_fast_ones_the_peaks() -> None:
    buffer = counted()
    for second in range(5):
        buffer.add(second, second * 2.0)
    assert points(buffer) == [(0, 0.0), (1, 2.0), (2, 4.0), (3, 6.0)]
    for at, value in ((10.0, 1.0), (10.05, 9.0), (10.1, 2.0), (10.15, -3.0), (10.19, 0.0)):
        buffer.add(at, value)
    buffer.flush(10.19)
    assert points(buffer)[-1] == (4, 8.0)
    buffer.flush(10.2)
    assert points(buffer)[-2:] == [(10.05, 9.0), (10.15, -3.0)]


@given(st.lists(st.tuples(st.floats(-0.5, 2.0), st.floats(-1e6, 1e6)), max_size=300))
def test_times_never_go_back_even_where_those_of_the_samples_do(steps: list[tuple[float, float]]) -> None:
    buffer, now = counted(), 100.0
    for step, value in steps:
        now += step
        buffer.add(now, value)
    buffer.flush(now + 1000)
    times = [at for at, _ in points(buffer)]
    assert times == sorted(times)
    assert {value for _, value in points(buffer)} <= {value for _, value in steps}
    if steps:
        highest = max(value for _, value in steps)
        assert highest in {value for _, value in points(buffer)}


def test_memory_is_bounded_at_any_rate_and_by_time() -> None:
    fast, slow = counted(), counted()
    for step in range(round(2 * SPAN * 50)):
        fast.add(step / 50, float(step % 7))
    assert round(SPAN / SLOT) < len(fast) <= CAPACITY
    assert points(fast)[0][0] >= SPAN - 30
    for step in range(5000):
        slow.add(step * 1.0, 1.0)
    assert len(slow) <= SPAN + 300
    still = counted()
    for _ in range(10_000):
        still.add(5.0, 1.0)
    assert len(still) == 0


@given(
    st.lists(
        st.one_of(
            st.tuples(st.just("a"), st.floats(0.01, 1.0)),
            st.tuples(st.just("b"), st.floats(0.01, 1.0)),
            st.tuples(st.just("mark"), st.floats(0.0, 1.0)),
            st.tuples(st.just("page"), st.floats(0.0, 0.5)),
            st.tuples(st.just("lost page"), st.floats(0.0, 0.5)),
        ),
        max_size=200,
    )
)
def test_no_point_and_no_mark_is_lost_or_doubled_between_pages(steps: list[tuple[str, float]]) -> None:
    recorder, now, state = SeriesRecorder(), 0.0, 0
    got: dict[FieldId, list[tuple[float, float]]] = {A: [], B: []}
    marks: list[Mark] = []
    recorder.build_page(SeriesRequest((A, B)), now, now)
    whole = dict(recorder.recorded)
    for number, (what, step) in enumerate([*steps, ("a", 1.0), ("page", 1.0)]):
        now += step
        if what in ("a", "b"):
            whole[A if what == "a" else B].add(now, float(number))
        elif what == "mark":
            recorder.marks.add(now, "key", str(number))
        else:
            page = recorder.build_page(SeriesRequest((A, B), state), now, now)
            assert page.after == state
            if what == "page":
                state = page.state
                marks += page.marks
                for field in (A, B):
                    got[field] += read(page, field)
    assert got == {field: points(whole[field]) for field in (A, B)}
    assert [mark.text for mark in marks] == [str(n) for n, (what, _) in enumerate(steps) if what == "mark"]


def test_a_page_fits_a_packet_and_the_next_ones_bring_the_rest() -> None:
    recorder = SeriesRecorder()
    fields = tuple(FieldId(1, 1, False, "M", f"f{number}") for number in range(MAX_FIELDS))
    recorder.pin(fields)
    for field, buffer in recorder.recorded.items():
        for step in range(1500):
            buffer.add(step * 0.25, float(fields.index(field)))
    state, total, pages = 0, 0, 0
    while state < MAX_FIELDS * 1500 and pages < 100:
        page = recorder.build_page(SeriesRequest(fields, state), 400.0, 0.0)
        assert len(encode(page)) < MAX_PACKET / 2
        count = sum(len(each.times) // 8 for each in page.points)
        assert count <= PAGE
        state, total, pages = page.state, total + count, pages + 1
    assert (total, pages) == (MAX_FIELDS * 1500, MAX_FIELDS * 1500 // PAGE)


def test_numbers_of_forgotten_points_make_no_empty_pages() -> None:
    recorder = SeriesRecorder()
    recorder.build_page(SeriesRequest((A,)), 0.0, 0.0)
    buffer = recorder.recorded[A]
    for step in range(60_000):
        buffer.add(step * 1.0, 1.0)
    page = recorder.build_page(SeriesRequest((A,)), 60_000.0, 0.0)
    assert page.state == 60_000
    assert read(page, A)[-1] == (59_999.0, 1.0)


def test_what_was_drawn_last_and_what_is_pinned_is_recorded() -> None:
    recorder = SeriesRecorder()
    recorder.pin((B,))
    recorder.build_page(SeriesRequest((A, B)), 0.0, 0.0)
    assert set(recorder.recorded) == {A, B}
    recorder.build_page(SeriesRequest((A,)), 3.0, 0.0)
    assert set(recorder.recorded) == {A, B}
    recorder.pin(())
    assert set(recorder.recorded) == {A}
    recorder.build_page(SeriesRequest(()), 4.0, 0.0)
    assert set(recorder.recorded) == set()


def test_a_request_for_too_many_fields_is_cut() -> None:
    recorder = SeriesRecorder()
    fields = tuple(FieldId(1, 1, False, "M", f"f{number}") for number in range(500))
    recorder.build_page(SeriesRequest(fields), 0.0, 0.0)
    assert len(recorder.recorded) == MAX_FIELDS


def test_suggested_fields_are_recorded_until_others_are_drawn() -> None:
    recorder = SeriesRecorder()
    recorder.suggest([A])
    assert recorder.recorded.keys() == {A}
    recorder.recorded[A].add(1.0, 5.0)
    assert recorder.build_page(SeriesRequest((), 0), 2.0, 0.0).state == 0, "a screen that opens names no field yet"
    assert read(recorder.build_page(SeriesRequest((A, B), 0), 2.0, 0.0), A) == [(1.0, 5.0)]
    recorder.build_page(SeriesRequest((B,), 0), 3.0, 0.0)
    recorder.suggest([A])
    assert recorder.recorded.keys() == {B}
