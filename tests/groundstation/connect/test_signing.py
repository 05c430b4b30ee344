"""Which key the ground station signs with, what it makes of unsigned vehicles, and mistakes in one line."""

from __future__ import annotations

import math
import time
from pathlib import Path

import pytest

from groundstation.connect.signing import SigningError, StationSigning, open_signing
from link.core import LinkReport, SigningCounts
from link.protocol.channel import Channel
from link.protocol.link_events import link_problem
from link.signing.key_actions import make_key, remove_key, use_key
from link.signing.key_file import station_key_file
from link.signing.role import SigningRole
from tests.link.frames import heartbeat
from tests.link.signing.signed import HERE, send, signed

PATIENCE = 10.0


@pytest.fixture
def keys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The key file of a user who has none yet."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return station_key_file()


def test_without_keys_nothing_is_signed(keys: Path) -> None:
    assert open_signing(0.0) is None


def test_the_named_key_signs_and_a_missing_name_is_told(keys: Path) -> None:
    for name in ("first", "second"):
        make_key(keys, name, SigningRole.SET_UP)
    for asked, signs in ((None, "first"), ("second", "second")):
        opened = open_signing(0.0, key=asked)
        assert opened is not None
        key = opened.signing.ring.signing_key
        assert key is not None
        assert key.name == signs
    with pytest.raises(SigningError, match=r"--sign-key third: there is no such key in .*; there are: first, second"):
        open_signing(0.0, key="third")


def test_signing_that_is_required_without_a_key_is_told(keys: Path) -> None:
    with pytest.raises(SigningError, match="`mavhelm sign new NAME` makes one"):
        open_signing(0.0, required=True)


def test_a_key_file_that_others_can_read_is_told(keys: Path) -> None:
    make_key(keys, "laptop", SigningRole.SET_UP)
    keys.chmod(0o644)
    with pytest.raises(SigningError, match="chmod 600"):
        open_signing(0.0)


def taken(station: StationSigning, now: float) -> str:
    """Let time pass until the thread has read the file; return what the log gets."""
    deadline = time.monotonic() + PATIENCE
    while (text := station.poll(now)) is None:
        assert time.monotonic() < deadline
        now += 1.0
        time.sleep(0.001)
    return text


def test_a_running_station_adopts_keys_made_chosen_and_forgotten(keys: Path) -> None:
    station = StationSigning(0.0)
    assert station.link_signing.guard(0) is None, "without keys nothing is computed"
    first = make_key(keys, "first", SigningRole.SET_UP)
    assert taken(station, 1.0) == f"keys changed: first ({first.fingerprint}); first signs"
    assert station.link_signing.guard(0) is not None
    make_key(keys, "second", SigningRole.SET_UP)
    use_key(keys, "second")
    while not taken(station, 100.0).endswith("second signs"):
        pass
    remove_key(keys, "first")
    remove_key(keys, "second")
    while "there is none; nothing is signed" not in taken(station, 200.0):
        pass
    assert station.link_signing.guard(0) is None
    assert station.version >= 3
    station.close()


def break_file(keys: Path) -> None:
    """Replace the file by one that is not TOML, whole: the thread may read at any moment."""
    broken = keys.with_name("broken")
    broken.write_text("[[key]")
    broken.chmod(0o600)
    broken.replace(keys)


def test_a_chosen_key_that_is_gone_and_a_broken_file_are_told(keys: Path) -> None:
    for name in ("first", "second"):
        make_key(keys, name, SigningRole.SET_UP)
    station = StationSigning(0.0, key="second", required=True)
    remove_key(keys, "second")
    assert taken(station, 1.0).endswith("first signs; --sign-key second is gone")
    break_file(keys)
    assert "the keys of before stay in force" in taken(station, 100.0)
    assert station.link_signing.signing.ring.find("first") is not None
    keys.unlink()
    assert "nothing unsigned is taken" in taken(station, 200.0)
    assert station.link_signing.guard(0) is not None, "who requires signing does not get less by losing the keys"
    station.close()


def test_another_process_reads_changed_keys_at_once(keys: Path) -> None:
    """As the watchdog does."""
    watchdog = StationSigning(0.0)
    make_key(keys, "first", SigningRole.SET_UP)
    watchdog.reload()
    assert watchdog.link_signing.signing.ring.find("first") is not None
    break_file(keys)
    watchdog.reload()
    assert watchdog.link_signing.signing.ring.find("first") is not None


@pytest.mark.parametrize("required", [False, True])
def test_vehicle_that_has_signed_is_trusted_only_while_it_signs(keys: Path, required: bool) -> None:
    key = make_key(keys, "laptop", SigningRole.SET_UP)
    opened = open_signing(0.0, required=required)
    assert opened is not None
    channel = Channel("udpin", 0, system=255, component=190, guard=opened.guard(0))
    assert bool(channel.receive(heartbeat(0, 1, 1), HERE, 0.0)) is not required
    stamp = opened.signing.clock.stamp(1.0)
    assert channel.receive(signed(key=key, stamp=stamp, ids=(1, 1)), HERE, 1.0)
    assert channel.report().verified == {1}
    for later in (1.0, 1e6):
        assert channel.receive(heartbeat(1, 1, 1), HERE, later) == []
    assert bool(channel.receive(heartbeat(0, 2, 1), HERE, 2.0)) is not required
    guard = opened.guard(0)
    assert guard is not None
    assert guard.policy.pinned_for == math.inf
    assert len(send(channel, now=3.0)) == 1


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        (SigningCounts(), None),
        (SigningCounts(bad=2), None),
        (SigningCounts(bad=3), "signed with a key that is not here"),
        (SigningCounts(too_old=3), "with a wrong time"),
        (SigningCounts(unsigned=3), "without a signature are dropped"),
    ],
)
def test_a_link_on_which_nothing_is_verified_says_why(counts: SigningCounts, said: str | None) -> None:
    problem = link_problem(LinkReport("udpin", refused=counts))
    assert problem is None if said is None else said in str(problem)
    assert link_problem(LinkReport("udpin", refused=counts, verified=frozenset({1}))) is None
