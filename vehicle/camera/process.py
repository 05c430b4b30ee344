"""The process of the camera: captures or draws pictures, stamps them, lets ffmpeg encode them, and sends the packets.

Run as `python -m vehicle.camera.process --fd N --setup JSON` by the daemon. It runs at a lower priority, its programs
are killed when it ends, and it ends with the daemon. Nothing it does can delay the daemon, which never waits for it.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import os
import signal
import socket
import time

import msgspec

from link.runtime.child_process import end_with_us
from link.runtime.local_socket import take_over
from link.services.video_stream import PAYLOAD_TYPE
from vehicle.camera.camera import CameraReport
from vehicle.camera.capture import build_capture, build_encoder, picture_size, stamp_picture
from vehicle.camera.copies import DelayedCopies
from vehicle.camera.orders import Orders, Setup
from vehicle.camera.scene import Scene

NICE = 10
"""How much lower the priority is than that of the daemon."""
REPORT_PERIOD = 1.0
RETRY = 2.0
"""s before a camera that failed is started again."""
STUCK_AFTER = 3.0
"""s for which the encoder takes no picture before it is started again."""
ORDERS_MAX = 1 << 16
"""Bytes of one packet of orders."""
SAID_MAX = 160
"""Characters of what a program says that are reported."""


class Relay(asyncio.DatagramProtocol):
    """Takes the RTP packets of ffmpeg and sends them to all who watch, `copies` times."""

    def __init__(self, copies: int) -> None:
        self.targets: tuple[tuple[str, int], ...] = ()
        self.bits = self.pictures = 0
        """Since the last report."""
        self._copies = DelayedCopies(copies - 1)
        self._sockets = {family: _sender(family) for family in (socket.AF_INET, socket.AF_INET6)}

    def datagram_received(self, data: bytes, addr: object) -> None:
        """Send a packet on; what is not RTP, such as the reports of RTCP, is dropped."""
        if len(data) < 12 or data[1] & 0x7F != PAYLOAD_TYPE:
            return
        self.pictures += data[1] >> 7  # the marker: the last packet of a picture
        self._send(data)
        idle = self._copies.next_due is None
        self._copies.add(data, time.monotonic())
        if idle:
            self._wait_for_copies()

    def close(self) -> None:
        """Send nothing any more."""
        self.targets = ()
        for each in self._sockets.values():
            if each is not None:
                each.close()

    def _wait_for_copies(self) -> None:
        if (due := self._copies.next_due) is not None:
            asyncio.get_running_loop().call_later(due - time.monotonic(), self._send_copies)

    def _send_copies(self) -> None:
        for packet in self._copies.pop_due(time.monotonic()):
            self._send(packet)
        self._wait_for_copies()

    def _send(self, data: bytes) -> None:
        self.bits += 8 * len(data)
        for host, port in self.targets:
            sender = self._sockets[socket.AF_INET6 if ":" in host else socket.AF_INET]
            if sender is not None:
                with contextlib.suppress(OSError):  # no route at present, or no room: a lost packet
                    sender.sendto(data, (host, port))


def _sender(family: socket.AddressFamily) -> socket.socket | None:
    try:
        sender = socket.socket(family, socket.SOCK_DGRAM)
    except OSError:
        return None
    sender.setblocking(False)
    return sender


class CameraProcess:
    """Runs the camera while somebody watches."""

    def __init__(self, setup: Setup, pipe: socket.socket) -> None:
        self._setup, self._settings, self._pipe = setup, setup.settings, pipe
        self._orders = Orders()
        self._relay = Relay(setup.settings.copies)
        self._ended = asyncio.Event()
        self._problem = ""

    async def run(self) -> None:
        """Obey the daemon until it ends."""
        loop = asyncio.get_running_loop()
        transport, _ = await loop.create_datagram_endpoint(lambda: self._relay, ("127.0.0.1", 0))
        port = transport.get_extra_info("sockname")[1]
        loop.add_reader(self._pipe, self._read)
        loop.add_signal_handler(signal.SIGTERM, self._ended.set)
        reporting = asyncio.ensure_future(self._report())
        streaming: asyncio.Task[None] | None = None
        while not self._ended.is_set():
            wanted = bool(self._orders.targets)
            if wanted and streaming is None:
                streaming = asyncio.ensure_future(self._stream_again(port))
            elif not wanted and streaming is not None:
                await _cancel(streaming)
                streaming, self._problem = None, ""
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._ended.wait(), 0.1)
        await _cancel(reporting)
        if streaming is not None:
            await _cancel(streaming)
        transport.close()
        self._relay.close()

    def _read(self) -> None:
        """Take the newest orders."""
        while True:
            try:
                data = self._pipe.recv(ORDERS_MAX)
            except BlockingIOError:
                return
            except OSError:
                data = b""
            if not data:
                asyncio.get_running_loop().remove_reader(self._pipe)
                self._ended.set()
                return
            self._orders = msgspec.json.decode(data, type=Orders)
            self._relay.targets = self._orders.targets

    async def _report(self) -> None:
        while True:
            await asyncio.sleep(REPORT_PERIOD)
            report = CameraReport(self._relay.pictures, self._relay.bits, self._problem)
            self._relay.pictures = self._relay.bits = 0
            with contextlib.suppress(OSError):
                self._pipe.send(msgspec.json.encode(report))

    async def _stream_again(self, port: int) -> None:
        """Stream, also after a failure."""
        while True:
            try:
                await self._stream(port)
            except (OSError, EOFError) as error:
                self._problem = _explain(error)
            await asyncio.sleep(RETRY)

    async def _stream(self, port: int) -> None:
        """Run the camera until one of its programs ends. Raises OSError, EOFError."""
        settings = self._settings
        async with contextlib.AsyncExitStack() as opened:
            words = build_capture(settings)
            if settings.kind == "command" and words is not None:
                ours, theirs = os.pipe()
                with os.fdopen(ours, "rb") as out, os.fdopen(theirs, "wb") as into:
                    camera = await _start(words, opened, stdout=into.fileno())
                    encoder = await _start(build_encoder(settings, port), opened, stdin=out.fileno())
                await _first_end(camera, encoder)
            encoder = await _start(build_encoder(settings, port), opened, stdin=asyncio.subprocess.PIPE)
            if words is None:
                await self._draw(encoder)
            else:
                camera = await _start(words, opened, stdout=asyncio.subprocess.PIPE, limit=picture_size(settings))
                await self._pass_on(camera, encoder)

    async def _draw(self, encoder: asyncio.subprocess.Process) -> None:
        """Draw what the simulated rover sees."""
        settings = self._settings
        scene = Scene(settings.width, settings.height, self._setup.walls)
        writer = _PictureWriter(encoder)
        due = time.monotonic()
        while True:
            at, orders = time.monotonic(), self._orders
            await writer.write(stamp_picture(settings, scene.draw(orders.pose, orders.waypoints), at))
            due = max(due + 1 / settings.rate, at)
            await asyncio.sleep(due - time.monotonic())

    async def _pass_on(self, camera: asyncio.subprocess.Process, encoder: asyncio.subprocess.Process) -> None:
        """Stamp the pictures of a program when they come."""
        assert camera.stdout is not None
        size, writer = picture_size(self._settings), _PictureWriter(encoder)
        while True:
            try:
                picture = await camera.stdout.readexactly(size)
            except asyncio.IncompleteReadError:
                await _first_end(camera)
            await writer.write(stamp_picture(self._settings, picture, time.monotonic()))


class _PictureWriter:
    """Writes pictures to the encoder; one that comes while it is busy is dropped."""

    def __init__(self, encoder: asyncio.subprocess.Process) -> None:
        assert encoder.stdin is not None
        self._encoder, self._pipe = encoder, encoder.stdin
        self._taken_at = time.monotonic()

    async def write(self, picture: bytes) -> None:
        """Write a picture. Raises EOFError if the encoder has ended, OSError if it stands still."""
        if self._encoder.returncode is not None or self._pipe.is_closing():
            await _first_end(self._encoder)
        now = time.monotonic()
        if self._pipe.transport.get_write_buffer_size() == 0:
            self._pipe.write(picture)
            self._taken_at = now
        elif now - self._taken_at > STUCK_AFTER:
            raise OSError(f"the encoder took no picture for {STUCK_AFTER:g} s")


async def _start(
    words: list[str], opened: contextlib.AsyncExitStack, *, stdin: int | None = None, stdout: int | None = None,
    limit: int = 1 << 16,
) -> asyncio.subprocess.Process:  # fmt: skip
    """Start a program that is killed at the end of the block, and with us. Raises OSError."""
    none = asyncio.subprocess.DEVNULL
    process = await asyncio.create_subprocess_exec(
        *words, stdin=none if stdin is None else stdin, stdout=none if stdout is None else stdout,
        stderr=asyncio.subprocess.PIPE, preexec_fn=end_with_us(signal.SIGKILL), limit=limit,
    )  # fmt: skip

    async def kill() -> None:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        process._transport.close()  # type: ignore[attr-defined]  # its pipes, which nobody reads any more
        await process.wait()

    opened.push_async_callback(kill)
    return process


async def _first_end(*processes: asyncio.subprocess.Process) -> None:
    """Wait until one of the programs ends. Raises EOFError with the last line that it said."""
    waiting = {asyncio.ensure_future(_last_line(process)): process for process in processes}
    done, rest = await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
    for task in rest:
        task.cancel()
    raise EOFError(next(iter(done)).result())


async def _last_line(process: asyncio.subprocess.Process) -> str:
    assert process.stderr is not None
    said = b""
    while data := await process.stderr.read(4096):
        said = (said + data)[-4096:]
    code = await process.wait()
    lines = said.decode(errors="replace").strip().splitlines()
    return "".join(each for each in (lines[-1] if lines else f"ended ({code})") if each.isprintable())[:SAID_MAX]


async def _cancel(task: asyncio.Task[None]) -> None:
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)


def _explain(error: Exception) -> str:
    if isinstance(error, FileNotFoundError):
        return f"{error.filename} is not installed: docs/camera.md says what is needed"
    return str(error)[:SAID_MAX] or type(error).__name__


def main() -> None:
    """Run the process."""
    parser = argparse.ArgumentParser("vehicle.camera.process", description="Started by `mavhelm vehicle`.")
    parser.add_argument("--fd", type=int, required=True)
    parser.add_argument("--setup", required=True)
    options = parser.parse_args()
    os.nice(NICE)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal: the daemon ends us
    pipe = take_over(options.fd)
    pipe.setblocking(False)
    asyncio.run(CameraProcess(msgspec.json.decode(options.setup, type=Setup), pipe).run())


if __name__ == "__main__":
    main()
