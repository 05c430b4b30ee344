"""Whether this is Linux inside of Windows (WSL), and what differs there: serial ports and UDP."""

from __future__ import annotations

from pathlib import Path

KERNEL = Path("/proc/sys/kernel/osrelease")
"""Has "microsoft" in it, as in "6.6.87.2-microsoft-standard-WSL2"; WSL 1 writes it with a capital letter."""

SERIAL_HINT = "WSL: attach a USB port with usbipd before it appears here; docs/windows.md"
UDP_HINT = "WSL: UDP of your network arrives with networkingMode=mirrored only; docs/windows.md"


def is_wsl(kernel: Path = KERNEL) -> bool:
    """Return whether the release of a kernel, as this file has it, is that of WSL. False where there is no file."""
    try:
        return "microsoft" in kernel.read_text(errors="replace").casefold()
    except OSError:
        return False


def wsl_hints(kernel: Path = KERNEL) -> tuple[str, ...]:
    """Return what to know about links in WSL, a line each; nothing elsewhere."""
    return (UDP_HINT, SERIAL_HINT) if is_wsl(kernel) else ()
