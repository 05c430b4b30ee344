"""Debian's own kernel for the virtual machine, and gpio-sim, built from its source because Debian leaves it out."""

from __future__ import annotations

import re
import shutil
import subprocess
import tarfile
from dataclasses import dataclass
from pathlib import Path

HEADERS = Path("/usr/src")
IMAGE = "linux-image-amd64"
PACKAGES = (
    "qemu-system-x86", "busybox-static", "linux-headers-amd64", "linux-source", "gcc", "make", "xz-utils", "kmod",
)  # fmt: skip
GPIO_SIM = ("drivers/gpio/gpio-sim.c", "drivers/gpio/gpiolib.h", "kernel/irq/irq_sim.c")
MAKEFILE = "obj-m := gpio_sim.o\ngpio_sim-y := gpio-sim.o irq_sim.o\n"
CHANGES = {
    # Debian's kernel does not export irq_to_desc(). The same, made of what it exports.
    "irq_to_desc(irqnum)": "irq_data_to_desc(irq_get_irq_data(irqnum))",
    # The pins of a Pi keep their level when their process dies (`persist_gpio_outputs` of its driver). gpio-sim would
    # set them back to their pull.
    "gc->free = gpio_sim_free;": "(void)gpio_sim_free;",
}
MODULES = (
    "virtio_ring", "virtio", "virtio_pci_legacy_dev", "virtio_pci_modern_dev", "virtio_pci",
    "netfs", "fscache", "9pnet", "9pnet_virtio", "9p", "overlay", "configfs", "i2c-dev", "i2c-stub",
)  # fmt: skip
"""In the order in which they need each other."""


class MissingError(Exception):
    """Something of this machine is missing; the text says what to install."""


@dataclass(frozen=True, slots=True)
class Kernel:
    """A kernel to boot."""

    image: Path
    modules: tuple[Path, ...]
    """In the order in which they are loaded."""


def prepare(folder: Path) -> Kernel:
    """Fetch the kernel and build its gpio-sim in `folder`, unless they are there. Raises MissingError."""
    release = _release()
    tree = folder / release
    if not (tree / "boot").exists():
        _fetch(release, tree)
    module = tree / "gpio-sim" / "gpio_sim.ko"
    if not module.exists():
        _build(release, module.parent)
    found = {path.stem: path for path in (tree / "lib/modules").rglob("*.ko")}
    return Kernel(next((tree / "boot").glob("vmlinuz-*")), (*(found[name] for name in MODULES), module))


def _release() -> str:
    """Return the newest installed headers, such as 6.1.0-56-amd64."""
    found = sorted(
        (path.name.removeprefix("linux-headers-") for path in HEADERS.glob("linux-headers-*-amd64")), key=_version
    )
    programs = ("qemu-system-x86_64", "busybox", "gcc", "make", "xz", "strip")
    if not found or not all(map(shutil.which, programs)) or not _source():
        raise MissingError(f"install first: apt-get install --no-install-recommends {' '.join(PACKAGES)}")
    return found[-1]


def _version(release: str) -> tuple[int, ...]:
    return tuple(map(int, re.findall(r"\d+", release)))


def _source() -> Path | None:
    """Return Debian's archive of the kernel's source."""
    return next(iter(sorted(HEADERS.glob("linux-source-*.tar.xz"))), None)


def _fetch(release: str, tree: Path) -> None:
    """Unpack the kernel's package without installing it: nothing of this machine's own boot changes."""
    packages = tree.parent / "packages"
    packages.mkdir(parents=True, exist_ok=True)
    name = f"linux-image-{release}"
    done = subprocess.run(
        ["apt-get", "download", "-q", name], cwd=packages, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise MissingError(f"apt-get download {name}: {done.stderr.strip()}")
    package = next(packages.glob(f"{name}_*.deb"))
    subprocess.run(["dpkg-deb", "--extract", str(package), str(tree)], check=True)
    package.unlink()


def _build(release: str, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    _unpack(folder)
    (folder / "Makefile").write_text(MAKEFILE)
    build = HEADERS / f"linux-headers-{release}"
    done = subprocess.run(
        ["make", "-C", str(build), f"M={folder}", "modules"], capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise MissingError(f"gpio-sim does not build for {release}:\n{done.stdout}{done.stderr}")
    subprocess.run(["strip", "--strip-debug", str(folder / "gpio_sim.ko")], check=True)


def _unpack(folder: Path) -> None:
    archive = _source()
    assert archive is not None, "checked by _release"
    wanted = set(GPIO_SIM)
    with tarfile.open(archive, "r|xz") as source:
        for member in source:
            inside = member.name.partition("/")[2]
            if inside in wanted and (file := source.extractfile(member)):
                (folder / Path(inside).name).write_text(_changed(file.read().decode()))
                wanted.remove(inside)
            if not wanted:
                return
    raise MissingError(f"{archive} has no {', '.join(sorted(wanted))}")


def _changed(text: str) -> str:
    for old, new in CHANGES.items():
        text = text.replace(old, new)
    return text
