"""The folder of the stations' sockets: closed to the group and to others, and of this user."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.station_socket.folder import FolderError, check_folder, make_folder


@pytest.mark.parametrize("mode", [0o700, 0o500, 0o600])
def test_a_folder_of_this_user_alone_is_used(tmp_path: Path, mode: int) -> None:
    tmp_path.chmod(mode)
    check_folder(tmp_path)
    tmp_path.chmod(0o700)


@pytest.mark.parametrize("mode", [0o740, 0o720, 0o710, 0o704, 0o702, 0o701, 0o777])
def test_a_folder_that_the_group_or_others_may_enter_is_refused(tmp_path: Path, mode: int) -> None:
    tmp_path.chmod(mode)
    with pytest.raises(FolderError, match=f"is open to other users: chmod 700 {tmp_path}"):
        check_folder(tmp_path)
    tmp_path.chmod(0o700)


def test_it_is_made_closed_whatever_the_umask(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert make_folder().stat().st_mode & 0o777 == 0o700
    make_folder().chmod(0o750)
    with pytest.raises(FolderError, match="chmod 700"):
        make_folder()


def test_a_link_or_a_file_in_its_place_is_refused(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path)
    (tmp_path / "file").touch(0o600)
    for name in ("link", "file"):
        with pytest.raises(FolderError, match="is not a folder"):
            check_folder(tmp_path / name)
