"""The chosen message: its last minute, sparks, payload; its lines for a CSV file."""

from __future__ import annotations

import csv
import io
from array import array

from hypothesis import given
from hypothesis import strategies as st

from dialects import codec
from dialects import messages as m
from groundstation.ipc import MAX_PACKET, encode
from groundstation.station.messages.message_capture import KEPT, MessageCapture
from groundstation.station.messages.message_detail import MessageInspector
from groundstation.station.messages.message_traffic import MessageTraffic
from groundstation.views.messages import CapturePage, CaptureRequest, MessageRequest, MessageView

REQUEST = MessageRequest(1, 1, False, "SYS_STATUS", "voltage_battery")


def status(volts: int) -> m.SysStatus:
    return m.SysStatus(0, 0, 0, 412, volts, 186, 76, 0, 3, 0, 0, 0, 0)


class Chosen:
    """Traffic with a message that a screen has chosen."""

    def __init__(self) -> None:
        self.traffic = MessageTraffic(255, 190)
        self.detail = MessageInspector(self.traffic)

    def view(self, now: float, request: MessageRequest = REQUEST) -> MessageView:
        view = self.detail.sources[MessageRequest].build(request, now, 0.0)
        assert isinstance(view, MessageView)
        return view

    def count(self, message: m.Message, now: float) -> None:
        self.traffic.count(message, 1, 1, now, known=True)


def test_a_plot_has_the_last_minute_in_usual_units() -> None:
    chosen = Chosen()
    chosen.count(status(12000), 0.0)
    assert chosen.view(0.0).plot is not None
    for second in range(1, 101):
        chosen.count(status(12000 + second), float(second))
        chosen.view(float(second))
    plot = chosen.view(100.0).plot
    assert plot is not None
    assert list(array("d", plot.times)) == [float(second) for second in range(40, 101)]
    assert [round(value, 3) for value in array("d", plot.values)][-1] == 12.1
    assert (plot.info.unit, plot.now) == ("V", 100.0)


def test_a_fast_message_is_kept_ten_times_a_second_only() -> None:
    chosen = Chosen()
    chosen.count(status(1), 0.0)
    chosen.view(0.0)
    for step in range(100_000):
        chosen.count(status(step % 1000), step / 1000)
        if step % 500 == 0:
            chosen.view(step / 1000)
    plot = chosen.view(100.0).plot
    assert plot is not None
    assert 550 <= len(plot.times) / 8 <= 600


def test_sparks_rise_with_the_values_and_texts_have_none() -> None:
    chosen = Chosen()
    chosen.count(status(0), 0.0)
    chosen.view(0.0)
    for second in range(9):
        chosen.count(status(second * 100), float(second))
    fields = {field.name: field.spark for field in chosen.view(9.0).fields}
    assert fields["voltage_battery"] == "▁▁▂▃▄▅▆▇█"
    assert fields["load"] == "▁▁▁▁▁▁▁▁▁"
    chosen.count(m.StatusText(4, b"hello", 0, 0), 9.0)
    text = MessageRequest(1, 1, False, "STATUSTEXT", "text")
    view = chosen.view(9.0, text)
    assert (view.plot, {field.name: field.spark for field in view.fields}["text"]) == (None, "")


def test_the_payload_is_that_of_the_newest_frame() -> None:
    chosen = Chosen()
    chosen.count(status(12104), 0.0)
    assert chosen.view(0.0).payload == codec.encode_payload(status(12104))


def test_array_item_is_plotted_and_too_large_index_is_the_last() -> None:
    chosen = Chosen()
    cells = [4000, 4100] + [0xFFFF] * 8
    battery = m.BatteryStatus(0, 0, 0, 2500, cells, 100, 10, 10, 70)
    request = MessageRequest(1, 1, False, "BATTERY_STATUS", "voltages", 1)
    chosen.count(battery, 0.0)
    chosen.view(0.0, request)
    chosen.count(battery, 1.0)
    plot = chosen.view(1.0, request).plot
    assert plot is not None
    assert list(array("d", plot.values)) == [4.1, 4.1]
    last = chosen.view(1.0, MessageRequest(1, 1, False, "BATTERY_STATUS", "voltages", 200)).plot
    assert last is not None
    assert (last.info.field.index, len(last.values)) == (9, 0)


def test_nothing_is_kept_for_a_hidden_screen() -> None:
    chosen = Chosen()
    chosen.count(status(1), 0.0)
    chosen.view(0.0)
    chosen.detail.tick(5.0)
    kind = chosen.traffic.find(((False, 1, 1), "SYS_STATUS"))
    assert kind is not None
    assert kind.taps == ()


# ---- lines of a CSV file ----


def page(capture: MessageCapture, after: int, now: float, name: str = "SYS_STATUS") -> CapturePage | None:
    return capture.build_page(CaptureRequest(1, 1, False, name, after), now, 1e9 + now)


@given(st.lists(st.sampled_from(["message", "page", "page that is lost"]), max_size=60))
def test_each_message_is_one_line_in_its_order(steps: list[str]) -> None:
    traffic = MessageTraffic(255, 190)
    capture, state, rows, sent = MessageCapture(traffic), 0, [], 0
    page(capture, 0, 0.0)
    for number, step in enumerate([*steps, "page"]):
        if step == "message":
            sent += 1
            traffic.count(status(sent), 1, 1, number / 10, known=True)
            continue
        found = page(capture, state, number / 10)
        if found is not None and step == "page":
            state = found.state
            rows += list(csv.DictReader(io.StringIO("\n".join((found.titles, *found.lines)))))
    assert [int(row["voltage_battery"]) for row in rows] == list(range(1, sent + 1))


def test_what_there_is_no_room_for_is_counted() -> None:
    traffic = MessageTraffic(255, 190)
    capture = MessageCapture(traffic)
    page(capture, 0, 0.0)
    for number in range(KEPT + 500):
        traffic.count(status(number), 1, 1, 0.0, known=True)
    found = page(capture, 0, 0.5)
    assert found is not None
    assert found.lost == 500
    assert len(encode(found)) < MAX_PACKET
    more = page(capture, found.state, 0.5)
    assert more is not None
    assert more.lost == 0


def test_texts_of_the_link_do_no_harm_in_a_spreadsheet() -> None:
    traffic = MessageTraffic(255, 190)
    capture = MessageCapture(traffic)
    page(capture, 0, 0.0, "STATUSTEXT")
    traffic.count(m.StatusText(4, b'=1+1\x1b,"a"', 0, 0), 1, 1, 0.0, known=True)
    found = page(capture, 0, 0.0, "STATUSTEXT")
    assert found is not None
    row = next(csv.DictReader(io.StringIO("\n".join((found.titles, *found.lines)))))
    assert row["text"].startswith("'=1+1")
    assert row["text"].isprintable()


def test_arrays_have_a_column_for_each_item() -> None:
    traffic = MessageTraffic(255, 190)
    capture = MessageCapture(traffic)
    page(capture, 0, 0.0, "ROVER_DRIVE_STATUS")
    traffic.count(m.RoverDriveStatus(0, 0, 1, 2, [3, 4, 5, 6], 0, 1, 1), 1, 1, 0.0, known=True)
    found = page(capture, 0, 0.0, "ROVER_DRIVE_STATUS")
    assert found is not None
    row = next(csv.DictReader(io.StringIO("\n".join((found.titles, *found.lines)))))
    assert [row[f"output[{index}]"] for index in range(4)] == ["3", "4", "5", "6"]
