"""Removing files and having checksums computed; several jobs one after the other."""

from __future__ import annotations

from link.services.ftp.client import FtpClient
from link.services.ftp.job import FtpOperation, FtpOutcome
from link.services.ftp.protocol import FtpError, crc32
from tests.link.ftp_rig import LOG, FtpRig
from tests.link.services_world import Pair


def run(client: FtpClient, pair: Pair) -> list[FtpOutcome]:
    pair.run_until(lambda: not client.busy, 60.0)
    return client.outcomes()


def test_jobs_run_in_their_order_whatever_is_lost() -> None:
    vehicle = FtpRig()
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client, loss=0.2, seed=8)
    numbers = [
        client.checksum("/logs/1.bin", pair.now),
        client.download("/logs/1.bin", pair.now),
        client.remove("/missions/old.plan", pair.now),
        client.remove("/missions/old.plan", pair.now),
        client.list_folder("/missions", pair.now),
        client.checksum("/logs/none.bin", pair.now),
    ]
    outcomes = run(client, pair)
    assert [outcome.number for outcome in outcomes] == numbers == [1, 2, 3, 4, 5, 6]
    assert [outcome.done for outcome in outcomes] == [True, True, True, False, True, False]
    assert outcomes[0].checksum == crc32(LOG)
    assert outcomes[1].data == LOG
    assert vehicle.written == [("old.plan", None)]
    assert [outcomes[3].error, outcomes[5].error] == [FtpError.NOT_FOUND] * 2
    assert outcomes[4].entries == ()
    assert outcomes[3].job is FtpOperation.REMOVE


def test_a_job_that_is_cancelled_leaves_the_others() -> None:
    vehicle = FtpRig(rate=20_000.0)
    client = FtpClient(255, 190, target_system=1)
    pair = Pair(vehicle.server, client)
    first = client.download("/logs/1.bin", pair.now)
    second = client.download("/logs/1.bin", pair.now)
    third = client.checksum("/logs/1.bin", pair.now)
    pair.run_until(lambda: client.progress[0] > 2000, within=5.0)
    assert client.number == first
    client.cancel(first, pair.now)
    client.cancel(second, pair.now)
    assert [outcome.number for outcome in run(client, pair)] == [third]
