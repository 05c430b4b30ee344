"""The initial file system of the virtual machine: busybox, the modules, what to run."""

from __future__ import annotations

import gzip
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from tests.vm.kernel import Kernel

INIT = Path(__file__).with_name("init.sh")
FOLDERS = ("bin", "modules", "proc", "sys", "dev", "host", "layer", "root")
TARGET = """\
[Unit]
DefaultDependencies=no
Requires=vm-tests.service
"""
SERVICE = """\
[Unit]
DefaultDependencies=no
Wants=systemd-journald.socket systemd-journald.service
After=systemd-journald.socket systemd-journald.service

[Service]
Type=oneshot
TimeoutStartSec=infinity
WorkingDirectory={tree}
Environment=MAVHELM_VM=1 PYTHONPATH={tree} HOME=/root LANG=C.UTF-8 PYTHONDONTWRITEBYTECODE=1
ExecStartPre=/bin/mount --bind /etc/vm-cpuinfo /proc/cpuinfo
ExecStart={command}
ExecStopPost=/bin/sh -c 'echo "vm: ended with $$EXIT_STATUS" > /dev/ttyS0; exec systemctl -ff poweroff'
StandardOutput=file:/dev/ttyS0
StandardError=file:/dev/ttyS0
"""


def build(kernel: Kernel, tree: Path, command: list[str], target: Path) -> None:
    """Write an initial file system to `target` that runs `command` in `tree`."""
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        for folder in FOLDERS:
            (root / folder).mkdir()
        shutil.copy(shutil.which("busybox") or "busybox", root / "bin/busybox")
        shutil.copy(INIT, root / "init")
        os.chmod(root / "init", 0o755)
        for module in kernel.modules:
            shutil.copy(module, root / "modules")
        (root / "vm.env").write_text(f'MODULES="{" ".join(module.stem for module in kernel.modules)}"\n')
        (root / "vm-tests.target").write_text(TARGET)
        (root / "vm-tests.service").write_text(SERVICE.format(tree=tree, command=" ".join(command)))
        target.write_bytes(gzip.compress(_archive(root), 1))


def _archive(root: Path) -> bytes:
    """Return the folder as a cpio archive, the form that the kernel reads."""
    names = "\n".join(str(path.relative_to(root)) for path in [root, *sorted(root.rglob("*"))])
    command = ["busybox", "cpio", "-o", "-H", "newc"]
    return subprocess.run(command, cwd=root, input=names.encode(), capture_output=True, check=True).stdout
