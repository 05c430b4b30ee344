"""SETUP_SIGNING: a key comes over a cable only, while disarmed, and is never repeated."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from dialects import codec
from dialects import messages as m
from link.signing.keys import KeyRing, SigningKey, new_key
from link.signing.role import SigningRole
from link.tlog.tlog import encode_record, read_records
from tests.vehicle.bench import Bench
from vehicle.commands.signing import Pairing
from vehicle.storage.store import PendingWrite

SECRET = bytes(range(1, 33))
PRINT = SigningKey("a", SigningRole.WATCH, SECRET).fingerprint


@dataclass
class Store:
    """Keeps keys in memory; `disk` says when they are written, and why not."""

    ring: KeyRing = field(default_factory=KeyRing)
    disk: PendingWrite = field(default_factory=lambda: PendingWrite(done=True))

    def add(self, key: SigningKey) -> PendingWrite:
        if not self.disk.problem:
            self.ring = self.ring.add(key)
        return self.disk


def bench_with(store: Store | None, *cables: int) -> Bench:
    class Paired(Bench):
        pairing = None if store is None else Pairing(store, frozenset(cables))

    return Paired()


def give(bench: Bench, secret: bytes = SECRET, target: int = 1, component: int = 1) -> list[str]:
    before = len(bench.texts)
    bench.say(m.SetupSigning(target, component, secret, 1))
    bench.wait(0.1)
    return bench.texts[before:]


def test_a_key_over_a_cable_is_stored_with_the_role_setup() -> None:
    store = Store()
    assert give(bench_with(store, 0)) == [f"Signing: key {PRINT} stored as cable-{PRINT}"]
    assert store.ring.keys == (SigningKey(f"cable-{PRINT}", SigningRole.SET_UP, SECRET),)


def test_the_answer_comes_once_the_key_is_on_the_disk() -> None:
    store = Store(disk=PendingWrite())
    bench = bench_with(store, 0)
    assert give(bench) == []
    store.disk.done = True
    bench.wait(0.1)
    assert len(bench.texts) == 1


def test_an_unwritable_key_is_reported_and_may_be_given_again() -> None:
    store = Store(disk=PendingWrite(done=True, problem="see the log of the vehicle"))
    bench = bench_with(store, 0)
    assert give(bench) == ["Signing: key not stored, see the log of the vehicle"]
    store.disk = PendingWrite(done=True)
    assert "stored as" in give(bench)[0]


def test_80_over_a_network_or_while_armed_it_is_refused() -> None:
    store = Store()
    assert give(bench_with(store, 1)) == ["Signing: refused, use a serial or USB cable"]
    bench = bench_with(store, 0)
    bench.drive()
    assert "Signing: refused while armed" in give(bench)
    assert store.ring == KeyRing()


def test_over_a_telemetry_radio_it_is_refused() -> None:
    store = Store()
    bench = bench_with(store, 0)
    bench.say(m.RadioStatus(100, 100, 100, 10, 10, 0, 0), 51)
    assert give(bench) == ["Signing: refused, not over a radio"]
    assert store.ring == KeyRing()


def test_without_a_folder_for_keys_it_is_refused() -> None:
    assert give(bench_with(None)) == ["Signing: refused, no folder for keys (--state)"]


def test_a_vehicle_with_keys_takes_no_unsigned_one() -> None:
    store = Store(KeyRing().add(new_key("laptop", SigningRole.SET_UP)))
    before = store.ring
    assert give(bench_with(store, 0)) == ["Signing: refused: 'mavhelm vehicle key install'"]
    assert give(bench_with(store, 0), bytes(32)) == ["Signing: to remove: 'mavhelm vehicle key revoke'"]
    assert store.ring == before


@pytest.mark.parametrize(("target", "component"), [(2, 1), (0, 1), (1, 100)])
def test_for_another_vehicle_or_component_it_is_not_ours(target: int, component: int) -> None:
    store = Store()
    assert give(bench_with(store, 0), SECRET, target, component) == []
    assert store.ring == KeyRing()


def test_a_refusal_repeats_at_most_every_3_s_without_the_key() -> None:
    bench = bench_with(Store(), 1)
    for _ in range(10):
        give(bench)
    assert len(bench.texts) == 1
    bench.wait(3.0)
    assert len(give(bench)) == 1
    assert not bench.all(m.SetupSigning)
    assert all(len(text) <= 50 for text in bench.texts)


def test_its_key_is_in_no_telemetry_log() -> None:
    message = m.SetupSigning(1, 1, SECRET, 1)
    frame = codec.frame(message.id, codec.encode_payload(message), 0, 255, 190)
    beat = codec.frame(0, codec.encode_payload(m.Heartbeat(6, 8, 0, 0, 4, 3)), 1, 255, 190)
    kept = encode_record(1_000_000, beat) + encode_record(1_000_001, frame) + encode_record(1_000_002, beat)
    assert SECRET not in kept
    assert [each.raw for each in read_records(kept)] == [beat, beat]
