"""A router, a simulated rover, `mavhelm ros2` and another node, for its tests."""

from __future__ import annotations

import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from groundstation.ros.services import SERVICES
from groundstation.ros.types import RosTypes
from groundstation.station_socket.connect import running_stations
from tests.e2e import ros2_peer
from tests.e2e.programs import Vehicle
from tests.e2e.ros2_peer import Peer
from tests.ports import free_port
from tests.waits import PATIENCE, Patience

STEP = 0.02
TRY = 5.0
"""s for a demand to turn the wheels; then its publisher begins anew."""

SET_BOOL = "std_srvs/srv/SetBool"
ARM = (
    "0/mavhelm_1/arm/std_srvs::srv::dds_::SetBool_/"
    "RIHS01_abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a"
)

LATE_FAILSAFE = ("--param", "FS_TIMEOUT=10", "--param", "FS_DISARM_T=300", "--param", "FS_GCS_TIMEOUT=120")
"""Where our node was late, its publisher begins anew; after HOLD or disarming only an operator could. Neutral comes as
soon as ever."""


class World:
    """A router, a vehicle, our node, and another node in this process."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self._folder, self.stack = folder, stack
        self.router, self.port = free_port(), free_port()
        self.router_process = self.start_router()
        self.vehicle = Vehicle(folder, self.port, *LATE_FAILSAFE)
        stack.callback(self.vehicle.end)
        self.peer = Peer(self.router)
        stack.callback(self.peer.close)

    def start_router(self) -> subprocess.Popen[bytes]:
        """Start the router."""
        process = ros2_peer.start("router", self.router)
        self.stack.callback(kill, process)
        return process

    def start_station(self) -> tuple[str, str]:
        """Start a station without a screen; return the options of a verb that goes through it."""
        command = [sys.executable, "-m", "groundstation", "serve", "--headless", self.endpoint]
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        self.stack.callback(kill, process)
        self.until(lambda: process.pid in running_stations(), "the station does not start")
        return "--station", str(process.pid)

    def start(self, *options: str) -> subprocess.Popen[bytes]:
        """Start our node, and wait until others see it."""
        way = () if "--station" in options else ("-e", self.endpoint, "--station", "never")
        command = [sys.executable, "-m", "groundstation", "ros2", *way, "--wait", "50"]
        command += ["--router", f"tcp/127.0.0.1:{self.router}", *options]
        with self.log.open("wb") as log:
            process = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        self.stack.callback(kill, process)
        self.until(lambda: "node /mavhelm_1 at" in self.text, "the node does not start")
        return process

    def until(self, condition: Callable[[], bool], missing: str, within: float = PATIENCE) -> None:
        patience = Patience(within)
        while not condition():
            assert not patience.ended, f"{missing}\n{self.text}"
            time.sleep(STEP)

    @property
    def endpoint(self) -> str:
        return f"udpin:127.0.0.1:{self.port}"

    @property
    def log(self) -> Path:
        return self._folder / "ros2.log"

    @property
    def text(self) -> str:
        return self.log.read_text() if self.log.exists() else ""

    def turns(self, zero: Callable[[], object] | None = None) -> None:
        """Wait until the wheels turn; their publisher shows `zero` now and then, as it must where our node was late.

        By default the peer shows it as a Twist. That of another publisher would only end the demand. A vehicle that was
        late by 2 s has disarmed: it is armed again where the node has that service.
        """
        patience = Patience(PATIENCE, self.vehicle.process.pid)
        while not patience.ended:
            with suppress(AssertionError):
                self.until(self.vehicle.turning, "the wheels do not turn", TRY)
                return
            with suppress(AssertionError):
                self.call(ARM, SET_BOOL, b"\x01")
            (zero or partial(self.peer.twist, 0.0))()
        raise AssertionError(f"the wheels do not turn\n{self.text}")

    def call(self, key: str, kind: str, request: bytes) -> Any:
        """Call a service; return the response."""
        types = RosTypes()
        types.register_service(kind, *SERVICES[kind])
        data, attachment = self.peer.call(key, request)
        assert struct.unpack("<qqB16s", attachment)[::3] == (3, b"c" * 16), "the response is not matched to the request"
        return types.decode(f"{kind}_Response", data)

    def stands(self) -> None:
        self.until(self.vehicle.stands, "the wheels turn on")

    @contextmanager
    def repeating(self, send: Callable[[], None]) -> Iterator[None]:
        """Publish at 20 Hz meanwhile."""
        ended = threading.Event()

        def run() -> None:
            while not ended.wait(0.05):
                send()

        thread = threading.Thread(target=run)
        thread.start()
        try:
            yield
        finally:
            ended.set()
            thread.join()


def kill(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait(PATIENCE)
    if process.stdout is not None:
        process.stdout.close()
