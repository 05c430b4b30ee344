"""The Messages screen: what it requests and shows, and what keys do on it."""

from __future__ import annotations

import msgspec
import pytest

from groundstation.actions import ACTIONS, OperatorAction
from groundstation.intents.driving import DriveKeyDown, EmergencyStop, Stop
from groundstation.intents.session import SetKeyGate, Watch
from groundstation.ui.key_gate import OTHER_SCREEN, TEXT_FIELD
from groundstation.ui.screens.messages import MessagesScreen
from groundstation.views.messages import MessageField, MessageRequest, MessageRow, MessagesPage, MessagesRequest
from tests.groundstation.ui.examples import DRIVE_WATCH, MESSAGES_PAGE, SYS_STATUS_VIEW, snapshot
from tests.groundstation.ui.pilots import Console, console, type_in
from tests.groundstation.ui.ptys import STANDARD, until

SYS_STATUS = MessageRequest(1, 1, False, "SYS_STATUS")
KEYS = [(action, key) for action in ACTIONS.values() for key in STANDARD.get_keys(action.id)]


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


async def test_it_requests_rows_and_the_selected_message_while_it_is_open() -> None:
    async with console() as screen:
        await open_messages(screen)
        assert len(newest(screen)) == 1
        await screen.press(*["down"] * 8)
        await until(lambda: SYS_STATUS in newest(screen))
        screen.station.offer_view(SYS_STATUS_VIEW)
        await screen.show(snapshot())
        assert "SYS_STATUS #1" in screen.text
        assert "12.104 V" in screen.text
        await screen.press("escape")
        await until(lambda: newest(screen) == DRIVE_WATCH.requests)


async def test_the_fields_of_another_message_are_not_shown() -> None:
    async with console() as screen:
        await open_messages(screen)
        await screen.press("down")
        screen.station.offer_view(SYS_STATUS_VIEW)
        await screen.show(snapshot())
        assert "12.104 V" not in screen.text
        await screen.press(*["down"] * 7)
        screen.station.offer_view(SYS_STATUS_VIEW)
        await screen.show(snapshot())
        assert "12.104 V" in screen.text
        await screen.press("up")
        assert "12.104 V" not in screen.text


async def test_the_filter_is_requested_while_it_is_typed_enter_keeps_it_and_escape_clears_it() -> None:
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


async def test_texts_of_a_vehicle_reach_the_terminal_without_control_characters() -> None:
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


@pytest.mark.parametrize(("action", "key"), KEYS, ids=[f"{action.id} {key}" for action, key in KEYS])
async def test_no_key_drives_there_and_each_stop_stops(action: OperatorAction, key: str) -> None:
    async with console() as screen:
        await open_messages(screen)
        assert screen.app.gate.closure == OTHER_SCREEN
        assert screen.station.of(SetKeyGate)[-1].open is False
        before = len(screen.station.intents)
        await screen.press(key)
        sent = [each for each in screen.station.intents[before:] if each in screen.station.wishes]
        kinds = {type(each) for each in sent} - {Watch}
        if action.group == "stop" and not action.confirm:
            assert kinds & {Stop, EmergencyStop}
        elif action.group != "app":
            assert kinds <= {DriveKeyDown, Stop}  # the station gets drive keys behind a closed gate: they are held
            assert screen.station.of(SetKeyGate)[-1].open is False


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
