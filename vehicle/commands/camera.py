"""The camera protocol: what the camera is, where its stream goes, and who watches. Nothing here moves the vehicle.

The camera is one without MAVLink that is attached to an autopilot: device 1 of this component.
https://mavlink.io/en/services/camera.html
"""

from __future__ import annotations

from collections.abc import Callable

from dialects import messages as m
from dialects.enums import Command, Result, Severity
from link.core import Outgoing, Received
from link.services.command.request import CommandRequest, value_or_default
from link.services.command.server import CommandReply
from link.services.video_stream import RTP_UDP, STAMPED
from link.signing.role import SigningRole
from vehicle.camera.camera import Camera
from vehicle.commands.access import Access, CommandResult
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context, Reporting
from vehicle.telemetry.view import TelemetryView

DEVICE, STREAM = 1, 1
RUNNING = 1
"""VIDEO_STREAM_STATUS_FLAGS_RUNNING."""
H264 = 1
"""VIDEO_STREAM_ENCODING_H264."""
HAS_VIDEO_STREAM = 256
"""CAMERA_CAP_FLAGS_HAS_VIDEO_STREAM."""
FIELD_OF_VIEW = 70
"""Degrees of the simulated camera; that of real ones is not known."""
Builder = Callable[[TelemetryView], m.Message]


class CameraCommands:
    """Answers for the camera; without one all is UNSUPPORTED."""

    def __init__(self, context: Context, reporting: Reporting) -> None:
        self._camera = reporting.camera
        self._texts = context.statustext
        self._build_view = reporting.build_view

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        connected, watch = Access.CONNECTED, SigningRole.WATCH  # a screen that only watches sends no HEARTBEAT
        return (
            CommandSpec(Command.VIDEO_START_STREAMING, self._start, connected,
                        "1: stream, 0 all; sent for 5 s and while its HEARTBEAT comes", role=watch),
            CommandSpec(Command.VIDEO_STOP_STREAMING, self._stop, connected, "1: stream, 0 all", role=watch),
            CommandSpec(Command.REQUEST_CAMERA_INFORMATION, self._legacy(m.CameraInformation), connected, "1: 1"),
            CommandSpec(Command.REQUEST_VIDEO_STREAM_INFORMATION, self._legacy(m.VideoStreamInformation), connected,
                        "1: stream, 0 all"),
            CommandSpec(Command.REQUEST_VIDEO_STREAM_STATUS, self._legacy(m.VideoStreamStatus), connected,
                        "1: stream, 0 all"),
        )  # fmt: skip

    def observe(self, received: Received, now: float) -> None:
        """Note who is there, and tell what is wrong with the camera."""
        if self._camera is not None and isinstance(received.message, m.Heartbeat):
            self._camera.hear(received.peer, now)
            for text in self._camera.pop_news():
                self._texts.send_event(Severity.WARNING, text, now)

    def note_request(self, message_id: int, request: CommandRequest, now: float) -> None:
        """Send pictures to who asks for the stream: QGroundControl asks, and starts no stream but a second one."""
        if self._camera is not None and message_id == m.VideoStreamInformation.id:
            self._camera.start(request.peer, now)

    def message_builders(self) -> dict[int, Builder]:
        """Return builders of what REQUEST_MESSAGE may ask for, by message id."""
        camera = self._camera
        if camera is None:
            return {}
        return {
            m.CameraInformation.id: lambda view: build_information(camera, view),
            m.VideoStreamInformation.id: lambda view: build_stream(camera, view),
            m.VideoStreamStatus.id: lambda view: build_stream_status(camera, view),
        }

    def _start(self, request: CommandRequest, now: float) -> Result:
        camera = self._find(request)
        if not isinstance(camera, Camera):
            return camera
        reason = camera.start(request.peer, now)
        if reason is None:
            return Result.ACCEPTED
        key = f"camera {request.peer} {reason}"  # a station asks again and again
        self._texts.reply_once(key, request, Severity.WARNING, f"Camera refused: {reason}", now)
        return Result.FAILED

    def _stop(self, request: CommandRequest, now: float) -> Result:
        camera = self._find(request)
        if not isinstance(camera, Camera):
            return camera
        camera.stop(request.peer)
        return Result.ACCEPTED

    def _find(self, request: CommandRequest) -> Camera | Result:
        """Return the camera, or why the request is not for it."""
        if self._camera is None:
            return Result.UNSUPPORTED
        return self._camera if value_or_default(request.params[0]) in (0, STREAM) else Result.DENIED

    def _legacy(self, message: type[m.Message]) -> Callable[[CommandRequest, float], CommandResult]:
        """Return the handler of a command that is older than REQUEST_MESSAGE."""

        def run(request: CommandRequest, now: float) -> CommandResult:
            camera = self._find(request)
            if not isinstance(camera, Camera):
                return camera
            self.note_request(message.id, request, now)
            found = self.message_builders()[message.id](self._build_view(now))
            return CommandReply(Result.ACCEPTED, (Outgoing(found, request.peer),))

        return run


def build_information(camera: Camera, view: TelemetryView) -> m.Message:
    """Build CAMERA_INFORMATION."""
    settings = camera.settings
    nan = float("nan")
    return m.CameraInformation(
        time_boot_ms=view.boot_ms,
        vendor_name=_bytes("mavhelm"),
        model_name=_bytes(settings.kind),
        firmware_version=0,
        focal_length=nan,
        sensor_size_h=nan,
        sensor_size_v=nan,
        resolution_h=settings.width,
        resolution_v=settings.height,
        lens_id=0,
        flags=HAS_VIDEO_STREAM,
        cam_definition_version=0,
        cam_definition_uri=b"",
        gimbal_device_id=0,
        camera_device_id=DEVICE,
    )


def build_stream(camera: Camera, view: TelemetryView) -> m.Message:
    """Build VIDEO_STREAM_INFORMATION of the one stream; its URI is the port at which a station listens."""
    settings, stamped = camera.settings, camera.settings.kind != "command"
    return m.VideoStreamInformation(
        stream_id=STREAM, count=1, type=RTP_UDP, flags=_flags(camera, view),
        framerate=settings.rate, resolution_h=settings.width, resolution_v=settings.height,
        bitrate=settings.bitrate * settings.copies * 1000, rotation=0,
        hfov=FIELD_OF_VIEW if settings.kind == "simulated" else 0,
        name=(STAMPED if stamped else "camera").encode(), uri=str(settings.port).encode(), encoding=H264,
        camera_device_id=DEVICE,
    )  # fmt: skip


def build_stream_status(camera: Camera, view: TelemetryView) -> m.Message:
    """Build VIDEO_STREAM_STATUS: what is sent at present."""
    settings, runs = camera.settings, camera.runs(view.now)
    return m.VideoStreamStatus(
        stream_id=STREAM, flags=_flags(camera, view), framerate=camera.report.pictures if runs else 0,
        resolution_h=settings.width, resolution_v=settings.height, bitrate=camera.report.bits if runs else 0,
        rotation=0, hfov=FIELD_OF_VIEW if settings.kind == "simulated" else 0, camera_device_id=DEVICE,
    )  # fmt: skip


def _flags(camera: Camera, view: TelemetryView) -> int:
    return RUNNING if camera.runs(view.now) else 0


def _bytes(text: str) -> list[int]:
    return list(text.encode()[:32].ljust(32, b"\0"))
