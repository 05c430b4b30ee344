"""The rules of macOS, forced on a Python of Linux, which imports this module by its name: its folder is in PYTHONPATH.

What macOS does not have is gone here, and what it does in its own way is done so. Programs that are started inherit it.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import os
import select
import signal
import socket
import struct
import sys
import time
from types import ModuleType
from typing import Any

LONGEST_ADDRESS = 103
"""Bytes of a path in a socket address: sun_path has 104."""
HIDDEN = ("/proc", "/sys", "/run")
MISSING: dict[ModuleType, tuple[str, ...]] = {
    os: ("O_PATH", "O_TMPFILE", "copy_file_range", "eventfd", "fdatasync", "getrandom", "memfd_create", "pidfd_open",
         "pipe2", "posix_fadvise", "posix_fallocate", "sched_getaffinity", "sched_setaffinity", "setns", "splice",
         "unshare", "waitid"),
    select: ("epoll",),
    signal: ("pidfd_send_signal", "sigtimedwait", "sigwaitinfo", "SIGPWR", "SIGSTKFLT", "SIGRTMIN", "SIGRTMAX"),
    socket: ("AF_NETLINK", "AF_PACKET", "AF_VSOCK", "SOCK_CLOEXEC", "SOCK_NONBLOCK", "SO_BINDTODEVICE", "SO_PEERCRED",
             "TCP_KEEPIDLE", "TCP_QUICKACK", "TCP_USER_TIMEOUT"),
    time: ("CLOCK_BOOTTIME", "CLOCK_TAI"),
}  # fmt: skip
"""What Python does not have on macOS, as far as programs use such things."""
NO_FUNCTIONS = ("prctl", "adjtimex", "inotify_init1", "timerfd_create")
"""Functions of Linux's C library."""

SO_PEERCRED = socket.SO_PEERCRED
LOCAL_PEERCRED, LOCAL_PEERPID = 1, 2
OPTIONS = {0x10: socket.TCP_KEEPIDLE, 0x101: socket.TCP_KEEPINTVL, 0x102: socket.TCP_KEEPCNT}
"""Options of TCP: the number on macOS -> that of Linux."""
DROP_TIME = 0x80
"""TCP_RXT_CONNDROPTIME: as TCP_USER_TIMEOUT, in s."""
SIOCGIFADDR = 0xC0206921


class Poll:
    """poll(), which reports no hangup of a descriptor of which no event is wanted."""

    def __init__(self) -> None:
        self._poll = _poll()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._poll, name)

    def register(self, descriptor: Any, events: int = select.POLLIN | select.POLLPRI | select.POLLOUT) -> None:
        if events:
            self._poll.register(descriptor, events)


def check_socket(event: str, arguments: tuple[Any, ...]) -> None:
    if event == "socket.__new__" and arguments[1] == socket.AF_UNIX:
        if arguments[2] & ~0xF:
            raise OSError(errno.EPROTOTYPE, "Protocol wrong type for socket")
        if arguments[2] == socket.SOCK_SEQPACKET:
            raise OSError(errno.EPROTONOSUPPORT, "Protocol not supported")
    elif event in ("socket.bind", "socket.connect") and arguments[0].family == socket.AF_UNIX:
        if not (path := os.fsencode(arguments[1])) or path[0] == 0:
            raise OSError(errno.ENOENT, "there are no abstract names")
        if len(path) > LONGEST_ADDRESS:
            raise OSError("AF_UNIX path too long")


def check_path(path: Any) -> None:
    if isinstance(path, str | bytes | os.PathLike):
        absolute = os.path.abspath(os.fsdecode(path))
        if any(absolute == each or absolute.startswith(f"{each}/") for each in HIDDEN):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), os.fsdecode(path))


def audit(event: str, arguments: tuple[Any, ...]) -> None:
    if event.startswith("socket."):
        check_socket(event, arguments)
    elif event in ("open", "os.listdir", "os.scandir") and arguments[0] is not None:
        check_path(arguments[0])


def socketpair(family: int = socket.AF_UNIX, kind: int = socket.SOCK_STREAM, *rest: Any) -> Any:
    check_socket("socket.__new__", (None, family, kind))
    return _socketpair(family, kind, *rest)


def getsockopt(sock: Any, level: int, option: int, *size: int) -> Any:
    if level == 0 and sock.family == socket.AF_UNIX:  # SOL_LOCAL
        pid, user, group = struct.unpack("3i", _getsockopt(sock, socket.SOL_SOCKET, SO_PEERCRED, 12))
        if option == LOCAL_PEERPID:
            return pid
        if option == LOCAL_PEERCRED:
            return struct.pack("IIh2x16I", 0, user, 1, group, *[0] * 15)
    return _getsockopt(sock, level, option, *size)


def setsockopt(sock: Any, level: int, option: int, *value: Any) -> None:
    if level == socket.IPPROTO_TCP and option == DROP_TIME:
        option, value = USER_TIMEOUT, (1000 * value[0],)
    elif level == socket.IPPROTO_TCP:
        option = OPTIONS.get(option, option)
    _setsockopt(sock, level, option, *value)


def connect(sock: Any, address: Any) -> None:
    """A socket that listens refuses when its queue is full."""
    try:
        _connect(sock, address)
    except BlockingIOError:
        if sock.family == socket.AF_UNIX:
            raise ConnectionRefusedError(errno.ECONNREFUSED, os.strerror(errno.ECONNREFUSED)) from None
        raise


def ioctl(descriptor: Any, request: int, *rest: Any) -> Any:
    return _ioctl(descriptor, 0x8915 if request == SIOCGIFADDR else request, *rest)


def hide_paths(name: str) -> None:
    """Let a function of os that no audit event reports see no hidden path."""
    function = getattr(os, name)

    def see(path: Any, *arguments: Any, **named: Any) -> Any:
        check_path(path)
        return function(path, *arguments, **named)

    setattr(os, name, see)


def look_up(library: ctypes.CDLL, name: str) -> Any:
    if name in NO_FUNCTIONS:
        raise AttributeError(name)
    return _look_up(library, name)


def add_module(name: str, **contents: Any) -> None:
    """Add a module that asks a framework of macOS, with what it says of a computer that has nothing."""
    module = ModuleType(name)
    vars(module).update(contents)
    sys.modules[name] = module


_poll, _socketpair, _ioctl, _look_up = select.poll, socket.socketpair, fcntl.ioctl, ctypes.CDLL.__getattr__
_getsockopt, _setsockopt, _connect = socket.socket.getsockopt, socket.socket.setsockopt, socket.socket.connect
USER_TIMEOUT = socket.TCP_USER_TIMEOUT
vars(socket).update(socketpair=socketpair, TCP_KEEPALIVE=0x10, TCP_KEEPINTVL=0x101, TCP_KEEPCNT=0x102)
vars(fcntl).update(ioctl=ioctl)
vars(select).update(poll=Poll)
for name, function in {"getsockopt": getsockopt, "setsockopt": setsockopt, "connect": connect}.items():
    setattr(socket.socket, name, function)
setattr(ctypes.CDLL, "__getattr__", look_up)  # noqa: B010
for name in ("stat", "lstat", "readlink", "access"):
    hide_paths(name)
for module, names in MISSING.items():
    for name in names:
        vars(module).pop(name, None)
add_module("serial.tools.list_ports_osx", comports=lambda include_links=False: [])
add_module("_scproxy", _get_proxy_settings=dict, _get_proxies=dict)
sys.platform = "darwin"
sys.addaudithook(audit)
