"""Test the motor drivers, the service and a serial link against a real kernel, in a virtual machine.

The machine is Debian's own kernel in QEMU, with this machine's files as its read-only root. Its pins are gpio-sim, its
I2C bus is i2c-stub, its serial ports are QEMU's. What the tests do is in tests/vm/inside.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.vm import initramfs
from tests.vm.kernel import Kernel, MissingError, prepare

TREE = Path(__file__).resolve().parents[2]
CACHE = Path("/var/tmp/mavhelm-vm")
PYTEST = ("-p", "no:cacheprovider", "-v", "--color=no", "--durations=0", "--tb=short", "--timeout=600")
ENDED = re.compile(r"^vm: ended with (\d+)", re.MULTILINE)


def main(words: list[str]) -> int:
    """Run the tests in the machine; return pytest's exit code, 2 if the machine cannot be made."""
    parser = argparse.ArgumentParser(prog="python -m tests.vm", description=__doc__.partition("\n")[0])
    parser.add_argument("--folder", type=Path, default=CACHE, help="keeps the kernel (default: %(default)s)")
    parser.add_argument(
        "--timeout", type=float, default=1800.0, metavar="S", help="until the machine is ended (default: 1800)"
    )
    parser.add_argument("tests", nargs="*", help="arguments for pytest (default: all tests of tests/vm/inside)")
    options = parser.parse_args(words)
    try:
        kernel = prepare(options.folder)
    except MissingError as error:
        print(f"vm: {error}", file=sys.stderr)
        return 2
    return run(kernel, options.tests or ["tests/vm/inside"], options.timeout)


def run(kernel: Kernel, tests: list[str], timeout: float) -> int:
    """Boot the machine, let it run the tests, show what they print."""
    with tempfile.TemporaryDirectory(prefix="mavhelm-vm-") as name:
        folder = Path(name)
        command = [sys.executable, "-m", "pytest", *PYTEST, *tests]
        initramfs.build(kernel, TREE, command, folder / "initramfs")
        begun = time.monotonic()
        console = _boot(kernel, folder, timeout)
        print(console.replace("\r", "").strip())
        print(f"vm: {time.monotonic() - begun:.0f} s from power on to power off, {kernel.image.name}")
    ended = ENDED.search(console)
    return int(ended[1]) if ended else 1


def _boot(kernel: Kernel, folder: Path, timeout: float) -> str:
    """Return what the machine wrote to its console."""
    cable = folder / "cable"  # from the second serial port to the third
    command = [
        "qemu-system-x86_64", "-accel", "tcg,thread=multi", "-cpu", "max", "-smp", "2", "-m", "1536",
        "-display", "none", "-nodefaults", "-no-reboot",
        "-serial", "stdio",
        "-chardev", f"socket,id=end1,path={cable},server=on,wait=off", "-serial", "chardev:end1",
        "-chardev", f"socket,id=end2,path={cable}", "-serial", "chardev:end2",
        "-kernel", str(kernel.image), "-initrd", str(folder / "initramfs"),
        "-append", "console=ttyS0 quiet panic=-1 systemd.log_level=warning systemd.show_status=0",
        "-virtfs", "local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap",
    ]  # fmt: skip
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout, check=False)
    except subprocess.TimeoutExpired as expired:
        return f"{(expired.stdout or b'').decode(errors='replace')}\nvm: not done within {timeout:g} s\n"
    return done.stdout.decode(errors="replace") + done.stderr.decode(errors="replace")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
