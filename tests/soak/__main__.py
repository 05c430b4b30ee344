"""Drive a rover through a bad network for a long time, with programs killed in between, and check every moment.

python -m tests.soak --minutes 60 --seed 1 --report soak.json
python -m tests.soak --minutes 60 --signing
python -m tests.soak --virtual-hours 24
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.extras import needing

with needing("test"):
    from tests.soak.soak import Soak
    from tests.soak.virtual import VirtualSoak


def main() -> int:
    """Run it; exit code 1 with faults."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=60.0, help="of real time, with the real programs")
    parser.add_argument("--virtual-hours", type=float, help="instead: hours of virtual time, both ends in this process")
    parser.add_argument("--trace", action="store_true", help="in virtual time: trace memory, three times as slow")
    parser.add_argument("--seed", type=int, default=1, help="of the weather, the kills and the drivers")
    parser.add_argument("--no-keys", action="store_true", help="no terminal: both stations without a screen")
    parser.add_argument("--signing", action="store_true", help="both ends sign, and ignore what is not signed")
    parser.add_argument("--report", type=Path, help="write the figures there, as JSON")
    options = parser.parse_args()
    with TemporaryDirectory(prefix="mavhelm-soak-") as folder:
        os.environ |= dict.fromkeys(("XDG_STATE_HOME", "XDG_CONFIG_HOME", "XDG_RUNTIME_DIR"), folder)  # not the user's
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # to compile at each start takes 40 MB, which hide all growth
        soak: Soak | VirtualSoak
        keys, signing = not options.no_keys, options.signing
        if options.virtual_hours:
            soak = VirtualSoak(options.virtual_hours * 3600, options.seed, signing=signing, trace=options.trace)
        else:
            soak = Soak(Path(folder), options.minutes * 60, options.seed, keys=keys, signing=signing)
        soak.run()
    text = json.dumps(soak.report(), indent=2)
    if options.report:
        options.report.write_text(text + "\n")
    print(text)
    return 1 if soak.findings.faults else 0


if __name__ == "__main__":
    sys.exit(main())
