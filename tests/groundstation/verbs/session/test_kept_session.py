"""The session that verbs share one after the other, and never at once."""

from __future__ import annotations

from pathlib import Path

from groundstation.station_socket.verb_run import KEEP
from groundstation.verbs.session.kept_session import KeptSession

OURS, OTHER = 254, 100


def test_the_next_verb_goes_on_with_the_session(tmp_path: Path) -> None:
    first = KeptSession.take(OURS, 10.0, tmp_path)
    first.end(50.0)
    second = KeptSession.take(OURS, 50.0 + KEEP, tmp_path)
    assert second.number == first.number
    assert KeptSession.take(OTHER, 51.0, tmp_path).number != first.number
    second.end(60.0)
    for later in (60.0 + KEEP + 1, 59.0):  # too late; and another boot of the computer
        other = KeptSession.take(OURS, later, tmp_path)
        assert other.number != first.number
        other.end(60.0)


def test_two_verbs_at_once_have_two_sessions(tmp_path: Path) -> None:
    first = KeptSession.take(OURS, 10.0, tmp_path)
    second = KeptSession.take(OURS, 10.1, tmp_path)
    assert second.number != first.number
    second.end(10.2)
    first.end(10.3)
    assert KeptSession.take(OURS, 10.4, tmp_path).number == first.number


def test_a_watching_verb_proves_only_while_no_other_verb_does(tmp_path: Path) -> None:
    assert KeptSession.follow(OURS, 1.0, tmp_path) is None
    first = KeptSession.take(OURS, 10.0, tmp_path)
    first.end(11.0)
    watching = KeptSession.follow(OURS, 12.0, tmp_path)
    assert watching is not None
    assert watching.number == first.number
    assert watching.may_prove(13.0)
    other = KeptSession.take(OURS, 13.1, tmp_path)
    assert other.number == first.number
    assert not watching.may_prove(13.2)
    other.end(14.0)
    assert watching.may_prove(14.1)
    for now in range(20, 200, 20):  # it keeps it for the next one
        assert watching.may_prove(float(now))
    late = KeptSession.take(OURS, 190.0, tmp_path)
    assert late.number == first.number
    watching.end(200.0)


def test_a_damaged_file_or_folder_is_no_obstacle(tmp_path: Path) -> None:
    for content in (b"", b"12", b"x y", b"5 nan", b"-1 10", b"\xff" * 100):
        (tmp_path / f"session-{OURS}").write_bytes(content)
        assert KeptSession.follow(OURS, 10.0, tmp_path) is None
        KeptSession.take(OURS, 10.0, tmp_path).end(11.0)
        assert KeptSession.follow(OURS, 11.0, tmp_path) is not None
    (tmp_path / "file").touch()
    alone = KeptSession.take(OURS, 10.0, tmp_path / "file")
    assert not alone.may_prove(10.0)
    alone.end(11.0)
