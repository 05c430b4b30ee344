"""The Messages screen: what it requests and shows, and what keys do on it."""

from __future__ import annotations

from pathlib import Path

import msgspec

from groundstation.actions import ACTIONS
from groundstation.intents.agents import DeclineProposal
from groundstation.intents.charts import PinSeries
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.services import RequestMessage, SetMessageRate
from groundstation.intents.session import SetKeyGate
from groundstation.intents.watch import Watch
from groundstation.ui.keys.key_gate import OTHER_SCREEN, TEXT_FIELD
from groundstation.ui.messages.screen import MessagesScreen
from groundstation.views.messages import (
    CapturePage,
    CaptureRequest,
    MessageField,
    MessageRequest,
    MessageRow,
    MessagesPage,
    MessagesRequest,
)
from groundstation.views.requests import RequestLine, RequestsRequest, RequestsView
from tests.groundstation.ui.examples import DRIVE_WATCH, MESSAGES_PAGE, SYS_STATUS_VIEW, snapshot
from tests.groundstation.ui.pilots import Console, console, type_in
from tests.groundstation.ui.ptys import STANDARD
from tests.waits import until

SYS_STATUS = MessageRequest(1, 1, False, "SYS_STATUS")
KEYS = [(action, key) for action in ACTIONS.values() if action.id != "app.quit" for key in STANDARD.get_keys(action.id)]


async def open_messages(screen: Console) -> MessagesScreen:
    await screen.press("f3")
    await until(lambda: newest(screen) != DRIVE_WATCH.requests)
    screen.station.offer_view(MESSAGES_PAGE)
    await screen.show(snapshot())
    top = screen.app.screen
    assert isinstance(top, MessagesScreen)
    return top


def newest(screen: Console) -> tuple[object, ...]:
    return screen.station.of(Watch)[-1].requests


def page_request(screen: Console) -> MessagesRequest:
    request = newest(screen)[0]
    assert isinstance(request, MessagesRequest)
    return request


async def test_it_requests_rows_and_the_selected_message_while_open() -> None:
    async with console() as screen:
        await open_messages(screen)
        assert len(newest(screen)) == 1
        await screen.press(*["down"] * 8)
        await until(lambda: SYS_STATUS in newest(screen))
        screen.station.offer_view(SYS_STATUS_VIEW)
        await screen.show(snapshot())
        assert "SYS_STATUS #1" in screen.text
        assert "41.2 %" in screen.text
        await screen.press("escape")
        await until(lambda: newest(screen) == DRIVE_WATCH.requests)


async def test_the_fields_of_another_message_are_not_shown() -> None:
    async with console() as screen:
        await open_messages(screen)
        await screen.press("down")
        screen.station.offer_view(SYS_STATUS_VIEW)
        await screen.show(snapshot())
        assert "41.2 %" not in screen.text
        await screen.press(*["down"] * 7)
        screen.station.offer_view(SYS_STATUS_VIEW)
        await screen.show(snapshot())
        assert "41.2 %" in screen.text
        await screen.press("up")
        assert "41.2 %" not in screen.text


async def test_typing_requests_filter_enter_keeps_and_escape_clears() -> None:
    async with console() as screen:
        top = await open_messages(screen)
        await screen.press("slash", *"src:1", "space", *"beat")
        await until(lambda: page_request(screen).text == "src:1 beat")
        assert screen.app.screen is top
        await screen.press("enter")
        await until(lambda: "filter “src:1 beat”" in screen.text)
        await screen.press("slash", "escape")
        await until(lambda: page_request(screen).text == "")
        assert screen.app.screen is top
        await screen.press("escape")
        await until(lambda: screen.app.screen is screen.app.drive)


async def test_a_filter_that_arrives_in_one_read_is_text() -> None:
    async with console() as screen:
        await open_messages(screen)
        type_in(screen, "/heart\r")
        await until(lambda: page_request(screen).text == "heart" and "filter “heart”" in screen.text)
        assert page_request(screen).closed == ()


async def test_order_and_closed_sources_are_requested() -> None:
    async with console() as screen:
        await open_messages(screen)
        await screen.press("enter")
        await until(lambda: page_request(screen).closed == ((1, 1, False),))
        await until(lambda: "▶ 1/1 Rover 1" in screen.text)
        await screen.press("o", "o")
        await until(lambda: page_request(screen).order == "rate" and "order: rate" in screen.text)


async def test_a_frozen_picture_requests_nothing_and_stays() -> None:
    async with console() as screen:
        await open_messages(screen)
        await screen.press("z")
        await until(lambda: newest(screen) == () and "FROZEN" in screen.text)
        other = (MessageRow(9, 9, False, "OTHER", 1.0, 1.0, 1, 0.0),)
        screen.station.offer_view(MessagesPage(other, 0, 1, 1, 1.0, 1.0))
        await screen.show(snapshot())
        assert "OTHER" not in screen.text
        assert "HEARTBEAT" in screen.text
        await screen.press("z")
        await until(lambda: len(newest(screen)) == 1 and "FROZEN" not in screen.text)


async def test_fields_scroll_behind_tab() -> None:
    fields = tuple(MessageField(f"field{number}", str(number), "") for number in range(60))
    async with console() as screen:
        await open_messages(screen)
        await screen.press(*["down"] * 8)
        screen.station.offer_view(msgspec.structs.replace(SYS_STATUS_VIEW, fields=fields))
        await screen.show(snapshot())
        assert "field59" not in screen.text
        await screen.press("tab", "end")
        await until(lambda: "field59" in screen.text and "field0 " not in screen.text)
        await screen.press("home", "tab", "up")
        await until(lambda: "choose a message" in screen.text)


async def test_vehicle_texts_reach_terminal_without_control_characters() -> None:
    field = MessageField("text", "\x1b[2Jboo\x07", "\x1b", "", ("a\x1bb",))
    async with console() as screen:
        await open_messages(screen)
        await screen.press(*["down"] * 8)
        rows = (msgspec.structs.replace(MESSAGES_PAGE.rows[0], label="\x1b]0;x\x07"), *MESSAGES_PAGE.rows[1:])
        screen.station.offer_view(msgspec.structs.replace(MESSAGES_PAGE, rows=rows))
        screen.station.offer_view(msgspec.structs.replace(SYS_STATUS_VIEW, fields=(field,)))
        await screen.show(snapshot())
        assert "boo" in screen.text
        assert not {"\x1b", "\x07"} & set(screen.text)


async def test_no_key_drives_there_and_each_stop_stops() -> None:
    async with console() as screen:
        for action, key in KEYS:
            if not screen.is_clean(MessagesScreen):
                await screen.go_home()
                await open_messages(screen)
            assert (shut := screen.app.gate.closure) is not None
            assert shut.reason == OTHER_SCREEN.reason, key
            assert screen.station.of(SetKeyGate)[-1].open is False, key
            before = len(screen.station.intents)
            await screen.press(key)
            sent = [each for each in screen.station.intents[before:] if each in screen.station.wishes]
            kinds = {type(each) for each in sent} - {Watch}
            if action.group == "stop" and not action.confirm:
                assert kinds & {Stop, EmergencyStop}, (action.id, key)
            elif action.group != "app":
                assert kinds <= {DriveKeyDown, Stop, DeclineProposal}, (
                    action.id,
                    key,
                )  # held keys reach it behind a closed gate
                assert screen.station.of(SetKeyGate)[-1].open is False, (action.id, key)


async def test_in_the_filter_letters_are_text_and_stops_still_work() -> None:
    async with console() as screen:
        await open_messages(screen)
        await screen.press("slash")
        await until(lambda: screen.app.gate.closure == TEXT_FIELD)
        before = len(screen.station.of(Stop))
        await screen.press("k", "space", "i")
        assert len(screen.station.of(Stop)) == before
        await screen.press("ctrl+k")
        assert len(screen.station.of(Stop)) == before + 1
        await screen.press("f9")
        assert screen.station.of(EmergencyStop)


def texts_in(folder: Path) -> list[str]:
    return [each.read_text("utf-8") for each in folder.iterdir()]


async def open_sys_status(screen: Console, *keys: str) -> None:
    """Open the screen, choose SYS_STATUS and let its fields arrive."""
    await open_messages(screen)
    await screen.press(*["down"] * 8)
    screen.station.offer_view(SYS_STATUS_VIEW)
    await screen.show(snapshot())
    await screen.press(*keys)


async def test_first_number_is_plotted_and_tab_chooses_another_field() -> None:
    async with console() as screen:
        await open_sys_status(screen)
        await until(lambda: msgspec.structs.replace(SYS_STATUS, field="load") in newest(screen))
        assert "load 39.0" in screen.text
        await screen.press("tab", "down")
        await until(lambda: msgspec.structs.replace(SYS_STATUS, field="voltage_battery") in newest(screen))
        await until(lambda: "›voltage_battery" in screen.text)
        await screen.press("right")
        await until(lambda: any(getattr(each, "index", 0) == 1 for each in newest(screen)))


async def test_p_records_the_plotted_field_for_charts() -> None:
    async with console() as screen:
        await open_sys_status(screen, "p")
        [pin] = screen.station.of(PinSeries)
        assert [field.name for field in pin.fields] == ["SYS_STATUS.load"]
        assert "is recorded for Charts" in screen.text
        await screen.press("f5")
        await until(lambda: "1 load" in screen.text)


async def test_raw_values_have_no_units_that_people_use() -> None:
    async with console() as screen:
        await open_sys_status(screen)
        assert "41.2 %" in screen.text
        await screen.press("e")
        await until(lambda: "412 d%" in screen.text and "41.2 %" not in screen.text)


async def test_a_rate_is_requested_and_its_end_is_shown() -> None:
    async with console() as screen:
        await open_sys_status(screen, "R")
        type_in(screen, "2.5\r")
        await until(lambda: screen.station.of(SetMessageRate))
        [sent] = screen.station.of(SetMessageRate)
        assert (sent.system, sent.component, sent.message, sent.rate) == (1, 1, 1, 2.5)
        await until(lambda: RequestsRequest() in newest(screen))
        end = RequestLine(sent.request, "refused", "send SYS_STATUS at 2.5 Hz", "DENIED: not now")
        screen.station.offer_view(RequestsView((), (end,)))
        await screen.show(snapshot())
        assert "send SYS_STATUS at 2.5 Hz: refused, DENIED: not now" in screen.text
        await until(lambda: RequestsRequest() not in newest(screen))
        await screen.press("Q")
        assert [each.message for each in screen.station.of(RequestMessage)] == [1]


async def test_a_wrong_rate_and_a_message_of_ours_are_not_requested() -> None:
    async with console() as screen:
        await open_sys_status(screen, "R", *"fast", "enter")
        await until(lambda: "“fast” is not a rate" in screen.text)
        await screen.press("end")
        screen.station.offer_view(msgspec.structs.replace(SYS_STATUS_VIEW, system=255, component=190, sent=True,
                                                          name="MANUAL_CONTROL"))  # fmt: skip
        await screen.show(snapshot())
        await screen.press("R", "Q")
        await until(lambda: "this station sends it" in screen.text)
        assert screen.station.of(SetMessageRate) == []
        assert screen.station.of(RequestMessage) == []


async def test_each_message_is_written_to_a_file_until_s_or_the_end(tmp_path: Path) -> None:
    async with console(folder=tmp_path) as screen:
        await open_sys_status(screen, "S")
        await until(lambda: CaptureRequest(1, 1, False, "SYS_STATUS") in newest(screen))
        screen.station.offer_view(CapturePage("time,load", ("1,412",), 1, 0))
        await screen.show(snapshot())
        await until(lambda: CaptureRequest(1, 1, False, "SYS_STATUS", 1) in newest(screen))
        await screen.press("S")
        assert "1 rows in" in " ".join(screen.text.split())
        await until(lambda: not any(isinstance(each, CaptureRequest) for each in newest(screen)))
    assert texts_in(tmp_path) == ["time,load\n1,412\n"]
