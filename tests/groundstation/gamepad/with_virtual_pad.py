"""The real `mavhelm`, whose reader of gamepads has virtual ones plugged in. Run as `python -m`."""

from __future__ import annotations

from groundstation.cli.main import main
from groundstation.gamepad import child

if __name__ == "__main__":
    child.READER = "tests.groundstation.gamepad.virtual_reader"
    raise SystemExit(main())
