"""The MAVLink C library, compiled here, accepts our signed frames and refuses what it must; we accept its own."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pymavlink
import pytest
from pymavlink.generator import mavgen

from link.signing.clock import TICKS
from link.signing.signature import link_and_stamp
from tests.link.frames import heartbeat
from tests.link.signing.signed import DAY, DRIVER, HERE, NOW, STRANGER, keep, signed, station
from tests.waits import PATIENCE

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")

SOURCE = Path(__file__).with_name("peer.c")
XML = Path(pymavlink.__file__).parent / "dialects/v20/minimal.xml"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The C library's headers for minimal.xml, and a small program with them."""
    folder = tmp_path_factory.mktemp("c")
    options = mavgen.Opts(str(folder), wire_protocol="2.0", language="C", validate=False)  # type: ignore[no-untyped-call]
    assert mavgen.mavgen(options, [str(XML)])  # type: ignore[no-untyped-call]
    made = folder / "peer"
    subprocess.run(["gcc", "-w", "-I", str(folder), "-o", str(made), str(SOURCE)], check=True, timeout=60)
    return made


def talk(program: Path, frames: Sequence[bytes]) -> tuple[list[str], bytes]:
    """Return what the library says of each frame, and a frame that it has signed."""
    lines = "".join(f"{frame.hex()}\n" for frame in frames)
    said = subprocess.run(
        [program, DRIVER.secret.hex(), str(NOW)],
        input=f"{lines}\n",
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE,
    ).stdout.splitlines()
    return said[:-1], bytes.fromhex(said[-1])


def test_it_accepts_ours_and_refuses_what_it_must(program: Path) -> None:
    verdicts = {
        "ours": (signed(stamp=NOW), "accepted"),
        "again": (signed(stamp=NOW), "refused"),
        "next": (signed(stamp=NOW + 1), "accepted"),
        "another link id, a little behind": (signed(stamp=NOW - 50 * TICKS, link_id=9), "accepted"),
        "yesterday": (signed(stamp=NOW - DAY, link_id=10), "refused"),
        "another key": (signed(stamp=NOW + 2, key=STRANGER), "refused"),
        "unsigned": (heartbeat(0), "refused"),
        "after all that": (signed(stamp=NOW + 3), "accepted"),
    }
    said, _ = talk(program, [frame for frame, _ in verdicts.values()])
    assert dict(zip(verdicts, said, strict=True)) == {name: verdict for name, (_, verdict) in verdicts.items()}


def test_we_accept_its_frames(program: Path) -> None:
    _, frame = talk(program, [])
    assert link_and_stamp(frame)[0] == 5
    [received] = station(keep(DRIVER)).receive(frame, HERE, 0.0)
    assert received.signed
    assert station(keep(STRANGER)).receive(frame, HERE, 0.0) == []
