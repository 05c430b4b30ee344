"""A router asks itself whether newcomers get in; real routers, one of them frozen."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from link.bridge.fleet import self_probe
from link.bridge.fleet.fleet_file import FILE, ROUTER, ROUTER_KEY, read_fleet_file
from link.bridge.fleet.self_probe import SelfProbe
from tests.e2e.fleet_programs import RouterProcess, make_fleet
from tests.waits import wait_until

LIMIT = """\
import resource
from link.bridge.fleet.self_probe import raise_descriptor_limit
print(raise_descriptor_limit(), resource.getrlimit(resource.RLIMIT_NOFILE))
"""


@pytest.fixture(scope="module", params=["tls", "quic"])
def router(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[RouterProcess]:
    folder = make_fleet(tmp_path_factory.mktemp("probe"), quic=request.param == "quic")
    with ExitStack() as stack:
        yield RouterProcess(folder, stack)


def probe_of(router: RouterProcess, ended: list[str], **times: float) -> SelfProbe:
    folder = router.log.parent
    return SelfProbe(read_fleet_file(folder / FILE).listen, folder, ended.append, **times)


def freeze(router: RouterProcess) -> None:
    """Stop a router, and wait until each of its threads stands: until then one may answer."""
    router.freeze()
    tasks = Path(f"/proc/{router.process.pid}/task")
    wait_until(
        lambda: all((each / "stat").read_text().rpartition(")")[2].split()[0] == "T" for each in tasks.iterdir())
    )


def test_a_router_that_answers_goes_on_for_ever(router: RouterProcess) -> None:
    probe = probe_of(router, [])
    assert [probe.check() for _ in range(5)] == [None] * 5
    assert router.process.poll() is None
    assert "router from" not in router.log.read_text(), "its own probes are not visitors"


def test_three_probes_in_a_row_without_an_answer_end_it(router: RouterProcess) -> None:
    ended: list[str] = []
    probe, by_itself = (probe_of(router, ended, period=0.01, timeout=0.2) for _ in range(2))
    freeze(router)
    try:
        assert [probe.check() for _ in range(2)] == [None, None]
        why = probe.check()
        by_itself.start()
        wait_until(lambda: ended)
    finally:
        router.thaw()
    assert why is not None
    assert why.endswith("has not let a newcomer in for 3 probes in 30 s (no answer)")
    assert ended == [why]


def test_an_answer_in_between_begins_anew(router: RouterProcess) -> None:
    probe = probe_of(router, [], timeout=1.0)
    for _ in range(2):
        freeze(router)
        try:
            assert [probe.check() for _ in range(2)] == [None, None]
        finally:
            router.thaw()
        wait_until(lambda: probe.check() is None and not any(probe._failed.values()))


def test_a_port_that_is_closed_does_not_answer(tmp_path: Path) -> None:
    folder = make_fleet(tmp_path)
    probe = SelfProbe(read_fleet_file(folder / FILE).listen, folder, lambda _: None)
    assert [probe.check() for _ in range(2)] == [None, None]
    assert "(connection refused)" in (probe.check() or "")


def test_a_certificate_that_cannot_connect_is_an_answer_too(router: RouterProcess, tmp_path: Path) -> None:
    """A fleet made by an older version has such a router's certificate; it must not end itself for that."""
    other = make_fleet(tmp_path)
    assert (other / ROUTER).exists()
    assert (other / ROUTER_KEY).exists()
    probe = SelfProbe(read_fleet_file(router.log.parent / FILE).listen, other, lambda _: None)
    assert [probe.check() for _ in range(4)] == [None] * 4


def test_the_limit_of_descriptors_is_raised_to_the_hard_one() -> None:
    soft, hard = 64, 512
    done = subprocess.run(
        [sys.executable, "-c", LIMIT],
        capture_output=True,
        text=True,
        check=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard)),
    )
    assert done.stdout.split(maxsplit=1) == ["512", "(512, 512)\n"]


def test_the_times_are_those_of_the_docs() -> None:
    assert (self_probe.PERIOD, self_probe.TIMEOUT, self_probe.TRIES) == (10.0, 5.0, 3)
