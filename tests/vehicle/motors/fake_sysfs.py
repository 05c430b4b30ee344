"""/sys/class/pwm on a real directory tree, with the kernel's rules about which value it takes when."""

from __future__ import annotations

from errno import EINVAL, ENODEV
from pathlib import Path


class FakeSysfs:
    """`root` is the class directory; two chips, whose numbers say nothing."""

    def __init__(self, directory: Path) -> None:
        self.root = directory / "class" / "pwm"
        self.root.mkdir(parents=True)
        self.writes: list[tuple[str, int]] = []
        self.refusing = ""
        """Writes to files of this name fail."""
        self._device(directory, "pwmchip0", "soc/107d517a80.pwm", channels=1)
        self._device(directory, "pwmchip2", "soc/fe20c000.pwm", channels=2)

    def write(self, path: Path, text: str) -> None:
        """What the kernel does with it."""
        value = int(text)
        if path.name == self.refusing:
            raise OSError(EINVAL, "Invalid argument", str(path))
        if path.name == "export":
            self._export(path.parent, value)
        else:
            self._check(path, value)
            # In one step, as the kernel does: a writer that is killed leaves the old value or the new one.
            new = path.with_name(f"new {path.name}")
            new.write_text(f"{value}\n")
            new.replace(path)
        self.writes.append((path.name, value))

    def channel(self, number: int) -> Path:
        """A channel of the chip that the tests use."""
        return self.root / "pwmchip2" / f"pwm{number}"

    def value(self, number: int, name: str) -> int:
        return int((self.channel(number) / name).read_text())

    def pulse(self, number: int) -> float | None:
        """s that the output is high in each period; None while it is off."""
        return self.value(number, "duty_cycle") * 1e-9 if self.value(number, "enable") else None

    def _device(self, directory: Path, chip: str, device: str, channels: int) -> None:
        real = directory / "devices" / "platform" / device / "pwm" / chip
        real.mkdir(parents=True)
        (real / "npwm").write_text(f"{channels}\n")
        (real / "export").touch()
        (self.root / chip).symlink_to(real)

    def _export(self, chip: Path, number: int) -> None:
        if number >= int((chip / "npwm").read_text()):
            raise OSError(ENODEV, "No such device", str(chip))
        (chip / f"pwm{number}").mkdir()
        for name in ("period", "duty_cycle", "enable"):
            (chip / f"pwm{number}" / name).write_text("0\n")

    def _check(self, path: Path, value: int) -> None:
        now = {name: int((path.parent / name).read_text()) for name in ("period", "duty_cycle", "enable")}
        now[path.name] = value
        if now["duty_cycle"] > now["period"] or (now["enable"] and not now["period"]):
            raise OSError(EINVAL, "Invalid argument", str(path))
