"""DO_SEND_BANNER and SETUP_SIGNING."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command, Result
from link.tlog.tlog import encode_record, read_records
from tests.vehicle.bench import OTHER, Bench


def test_the_banner() -> None:
    bench = Bench(DRIVE_TYPE=2)
    assert bench.command(Command.DO_SEND_BANNER, introduced=False) is Result.TEMPORARILY_REJECTED
    assert bench.texts == []
    assert bench.command(Command.DO_SEND_BANNER, system=OTHER) is Result.ACCEPTED
    bench.wait(0.1)
    assert bench.texts == ["mavhelm 0.1.0, ackermann drive, mode MANUAL"]


class TestSigning:
    KEY = bytes(range(32))

    def test_it_is_told_once_and_never_repeated_back(self) -> None:
        bench = Bench()
        bench.heartbeat()
        sent = len(bench.sent)
        for _ in range(5):
            bench.say(m.SetupSigning(1, 1, self.KEY, 1))
            bench.wait(1.0)
        assert bench.texts == ["Signing is not offered: the key was not used"]
        assert not any(isinstance(each, m.SetupSigning) for each in bench.sent[sent:])

    def test_for_another_vehicle_it_is_not_ours(self) -> None:
        bench = Bench()
        bench.say(m.SetupSigning(2, 1, self.KEY, 1))
        bench.wait(0.1)
        assert bench.texts == []

    def test_its_key_is_in_no_telemetry_log(self) -> None:
        from dialects import codec

        message = m.SetupSigning(1, 1, self.KEY, 1)
        frame = codec.frame(message.id, codec.encode_payload(message), 0, 255, 190)
        beat = codec.frame(0, codec.encode_payload(m.Heartbeat(6, 8, 0, 0, 4, 3)), 1, 255, 190)
        kept = encode_record(1_000_000, beat) + encode_record(1_000_001, frame) + encode_record(1_000_002, beat)
        assert self.KEY not in kept
        assert [each.raw for each in read_records(kept)] == [beat, beat]
