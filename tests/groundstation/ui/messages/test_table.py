"""The rows and fields of messages whose id is in no dialect."""

from __future__ import annotations

from groundstation.ui.look.colours import DIM, TEXT, style
from groundstation.ui.messages.detail import MessageDetail, MessageDetailValue
from groundstation.ui.messages.table import MessageTable, MessageTableValue
from groundstation.views.messages import MessageRow, MessageView
from tests.groundstation.ui.frames import texts

UNKNOWN = MessageRow(1, 1, False, "#51000", 4.0, 124.0, 40, 0.2, label="31 B", unknown=True)
KNOWN = MessageRow(1, 1, False, "HEARTBEAT", 1.0, 21.0, 10, 0.2)


def test_an_unknown_id_is_dim_and_has_the_length_of_its_frames() -> None:
    lines = MessageTable(MessageTableValue((KNOWN, UNKNOWN))).draw(60, 4)
    assert texts(lines)[1].split() == ["HEARTBEAT", "1.0", "21", "0.2", "10"]
    assert texts(lines)[2].split() == ["#51000", "31", "B", "4.0", "124", "0.2", "40"]
    styles = [
        next(part.style for part in line if name in part.text)
        for line, name in zip(lines[1:], ("HEART", "#510"), strict=True)
    ]
    assert [each and each.color for each in styles] == [style(TEXT).color, style(DIM).color]


def test_instead_of_fields_it_says_what_names_them() -> None:
    view = MessageView(1, 1, False, "#51000", 51000, 4.0, 40, 0.2, 31, ())
    lines = texts(MessageDetail(MessageDetailValue(view)).draw(40, 10))
    assert " ".join(" ".join(lines).split()) == (
        "this id is in no dialect known here: start with --dialect FILE.xml, the file of the vehicle's dialect"
    )
    assert all(len(line) <= 40 for line in lines)
