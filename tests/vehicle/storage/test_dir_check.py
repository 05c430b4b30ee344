"""Where things cannot be kept, it is one line that says why and what to do; and nothing is left behind."""

from __future__ import annotations

import contextlib
import os
import resource
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from vehicle.storage.dir_check import PROBE_SIZE, write_problem

NOBODY = 65534


@pytest.fixture
def open_folder() -> Iterator[Path]:
    """A folder that every user reaches, which pytest's own are not."""
    with tempfile.TemporaryDirectory() as name:
        os.chmod(name, 0o755)
        yield Path(name)


@contextlib.contextmanager
def somebody_else() -> Iterator[None]:
    """As another user, where this one is root, who may write anywhere."""
    before = os.geteuid()
    if before == 0:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(before)


def test_a_folder_that_is_well_and_one_that_can_be_made(tmp_path: Path) -> None:
    assert write_problem(tmp_path, "state") is None
    assert write_problem(tmp_path / "not" / "there", "state") is None
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_its_place_or_on_the_way(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    told = f"{tmp_path}/file is not a folder; remove it, or set another folder with state"
    assert write_problem(tmp_path / "file", "state") == told
    assert write_problem(tmp_path / "file" / "logs", "state") == told


def test_a_link_to_nowhere_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    assert "link is not a folder" in (write_problem(tmp_path / "link", "state") or "")


@pytest.mark.parametrize("below", ["", "logs/deep"])
def test_a_folder_of_another_user(open_folder: Path, below: str) -> None:
    os.chmod(open_folder, 0o555)
    with somebody_else():
        told = write_problem(open_folder / below, "log.tlog")
    assert told is not None
    assert told.startswith(f"{open_folder} is not writable by ")
    assert told.endswith("or set another folder with log.tlog")
    if os.geteuid() == 0:
        assert ", it belongs to root; run this as root" in told
    else:
        assert ", chmod u+rwx it" in told


def test_a_folder_behind_a_closed_door(open_folder: Path) -> None:
    (open_folder / "door" / "room").mkdir(parents=True)
    os.chmod(open_folder / "door", 0)
    with somebody_else():
        told = write_problem(open_folder / "door" / "room", "state")
    os.chmod(open_folder / "door", 0o755)
    assert told is not None
    assert f"{open_folder}/door" in told


def test_a_link_into_what_a_service_keeps_for_itself(open_folder: Path) -> None:
    """As systemd has it with DynamicUser: /var/lib/mavhelm leads into /var/lib/private, which is root's alone."""
    (open_folder / "private" / "mavhelm").mkdir(parents=True)
    (open_folder / "mavhelm").symlink_to(open_folder / "private" / "mavhelm")
    os.chmod(open_folder / "private", 0)
    with somebody_else():
        told = write_problem(open_folder / "mavhelm", "state")
    os.chmod(open_folder / "private", 0o755)
    assert told is not None
    assert "cannot be examined; run this with sudo" in told


def test_a_disk_that_takes_no_more(tmp_path: Path) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (PROBE_SIZE // 2, limits[1]))
    try:
        told = write_problem(tmp_path, "state")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert told == f"{tmp_path} is full; free some space, or set another folder with state"
    assert list(tmp_path.iterdir()) == []


def test_a_file_system_that_takes_no_files() -> None:
    told = write_problem(Path("/proc"), "state")
    assert told is not None
    assert told.startswith("/proc ")
    assert "or set another folder with state" in told
