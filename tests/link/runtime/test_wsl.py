"""WSL is told from Linux by the release of its kernel."""

from __future__ import annotations

from pathlib import Path

import pytest

from link.runtime.wsl import KERNEL, SERIAL_HINT, UDP_HINT, is_wsl, wsl_hints

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("release", "wsl"),
    [
        ("6.6.87.2-microsoft-standard-WSL2\n", True),
        ("5.15.90.1-microsoft-standard-WSL2+\n", True),
        ("4.4.0-19041-Microsoft\n", True),
        ("6.12.43+deb13-amd64\n", False),
        ("6.12.34+rpt-rpi-2712\n", False),
        ("", False),
    ],
)
def test_the_kernel_says_whether_this_is_wsl(tmp_path: Path, release: str, wsl: bool) -> None:
    kernel = tmp_path / "osrelease"
    kernel.write_text(release)
    assert is_wsl(kernel) == wsl
    assert wsl_hints(kernel) == ((UDP_HINT, SERIAL_HINT) if wsl else ())


def test_a_system_without_that_file_is_not_wsl(tmp_path: Path) -> None:
    assert not is_wsl(tmp_path / "nothing")


def test_the_file_of_linux_is_read() -> None:
    assert KERNEL.read_text().strip()


def test_each_hint_names_its_page() -> None:
    page = (ROOT / "docs/windows.md").read_text()
    for hint, word in ((SERIAL_HINT, "usbipd"), (UDP_HINT, "networkingMode=mirrored")):
        assert word in hint
        assert word in page
        assert hint.endswith("docs/windows.md")
