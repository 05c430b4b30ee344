"""What a tab may send, and how much of it."""

from __future__ import annotations

import pytest

from groundstation.input.touch_stick import TouchReading
from groundstation.web.messages import (
    BURST,
    CHARACTERS,
    MESSAGES,
    PASTES,
    Blurred,
    Focused,
    Pinged,
    Resized,
    Size,
    TabMessage,
    TabMessageError,
    TabMessages,
    Touched,
    Typed,
)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('["stdin", "i"]', Typed("i")),
        ('["stdin", "\\u001b[105;1:1;105u"]', Typed("\x1b[105;1:1;105u")),
        ('["resize", {"width": 100, "height": 30}]', Resized(Size(100, 30))),
        ('["ping", "1"]', Pinged("1")),
        ('["focus"]', Focused()),
        ('["blur"]', Blurred()),
        (
            '["pad", {"at": 12.5, "held": true, "x": -1, "y": 0.5, "buttons": ["start", "b"]}]',
            Touched(TouchReading(12.5, True, -1.0, 0.5, ("start", "b"))),
        ),
    ],
)
def test_messages_of_textual_js_and_of_our_page(text: str, message: TabMessage) -> None:
    assert TabMessages().read(text, 1.0) == message


def test_a_refusal_has_no_word_of_the_message_and_fits_a_close() -> None:
    for text in ('["evil"]', '["stdin", "evil"', '["pad", {"evil": 1}]', "evil", '["evil' + "x" * 5000):
        with pytest.raises(TabMessageError) as refused:
            TabMessages().read(text, 1.0)
        assert "evil" not in str(refused.value)
        assert len(str(refused.value).encode()) <= 123, "RFC 6455, 5.5"


def test_messages_are_bounded_in_number() -> None:
    messages = TabMessages()
    for _ in range(int(BURST)):
        messages.read('["focus"]', 1.0)
    with pytest.raises(TabMessageError, match="more than 400 messages per s"):
        messages.read('["focus"]', 1.0)
    for _ in range(int(MESSAGES)):
        messages.read('["focus"]', 2.0)
    with pytest.raises(TabMessageError):
        messages.read('["focus"]', 2.0)


def test_messages_are_bounded_in_size() -> None:
    messages = TabMessages()
    paste = f'["stdin", "{"x" * 65_000}"]'
    for _ in range(int(PASTES) // len(paste)):
        messages.read(paste, 1.0)
    with pytest.raises(TabMessageError, match="more than 65536 characters per s"):
        messages.read(paste, 1.0)
    assert len(paste) < CHARACTERS
    messages.read(paste, 2.0)
