"""The parameters of one vehicle: fetched as a file or as a list, read and set one by one.

How integers are encoded must be known first: requests wait until the vehicle's capabilities are settled.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import msgspec

from dialects.enums import ParamErrorCode
from dialects.result_texts import param_error_text
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.state.identity import VehicleIdentity
from link.core import Received
from link.services.param.client import ParamClient, ParamOutcome
from link.services.param.float32 import float32_neighbours, value_text
from link.services.param.values import is_bytewise, value_fault

if TYPE_CHECKING:
    from groundstation.vehicles.requests.file_requests import FileRequests
    from link.services.ftp.job import FtpOutcome

FILE_PATIENCE = 3
"""Requests for param.pck without a reply before the list is requested: 2 s, for vehicles without a file service."""


class _Access(msgspec.Struct):
    """A read, or a set (`wanted`), of one parameter."""

    number: int
    name: str
    wanted: float | None
    before: float | None = None


class ParamRequests:
    """Requests about parameters; `client.params` are the known values. `autopilot` returns MAV_AUTOPILOT."""

    def __init__(
        self,
        client: ParamClient,
        files: Callable[[], FileRequests],
        identity: VehicleIdentity,
        book: RequestBook,
        autopilot: Callable[[], int],
    ) -> None:
        self.client = client
        self._files = files
        self._identity = identity
        self._book = book
        self._autopilot = autopilot
        self._fetch: int | None = None
        """Number of the request that fetches all."""
        self._file: int | None = None
        """FTP job that downloads param.pck."""
        self._waiting: list[Callable[[float], None]] = []
        """Steps that wait for the capabilities."""
        self._access: dict[str, _Access] = {}

    # ---- requests ----

    def fetch(self, number: int, now: float) -> None:
        """Fetch all parameters: as a file, which brings the defaults, else as a list; or what a list still lacks."""
        missing = len(self.client.missing)
        if not self._book.begin(number, f"fetch {missing} missing parameters" if missing else "fetch parameters"):
            return
        if self._fetch is not None:
            self._book.refuse(number, "parameters are being fetched already", now, by_vehicle=False)
            return
        self._fetch = number
        self._when_settled(self._begin_fetch, now)

    def read(self, number: int, name: str, now: float) -> None:
        """Read one parameter."""
        if self._begin_access(_Access(number, name, None), f"read {name}", now):
            self._when_settled(lambda later: self.client.read(name, later), now)

    def set(self, number: int, name: str, value: float, now: float) -> None:
        """Set one parameter. One that is not known is read first: its type decides how it is sent."""
        if not self._begin_access(_Access(number, name, value), f"set {name} to {value_text(value)}", now):
            return
        first = self._set_known if name in self.client.params else self.client.read
        self._when_settled(lambda later: first(name, later), now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a fetch. A read or set ends by itself within seconds."""
        if number != self._fetch:
            return
        if self._file is not None:
            self._files().cancel_job(self._file, now)
        self.client.stop_fetch()
        self._book.cancel(number)
        self._fetch = self._file = None

    def forget(self) -> None:
        """Forget all values, unless they are being read or set: the vehicle may have restarted with others."""
        if self._fetch is None and not self._access:
            self.client.forget()

    @property
    def fetching(self) -> bool:
        """Whether all parameters are being fetched."""
        return self._fetch is not None

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self.client.receive(received, now)
        self._handle_outcomes(now)
        self._watch_fetch()

    def tick(self, now: float) -> None:
        """Begin what has waited, repeat what is overdue, report progress."""
        if self._waiting and self._identity.settled:
            self._settle()
            waiting, self._waiting = self._waiting, []
            for step in waiting:
                step(now)
        self.client.tick(now)
        self._handle_outcomes(now)
        self._watch_fetch()

    # ---- all ----

    def _begin_fetch(self, now: float) -> None:
        if self._fetch is None:  # cancelled while it waited
            return
        if self.client.missing:
            self.client.fetch_missing(now)
        elif self._identity.may_have_files:
            from link.services.param.unpack import PATH_WITH_DEFAULTS  # a verb that sets one parameter needs no file

            self._file = self._files().start_download(PATH_WITH_DEFAULTS, self._take_file, now, patience=FILE_PATIENCE)
        else:
            self.client.fetch(now)

    def _take_file(self, outcome: FtpOutcome, now: float) -> None:
        """Load all parameters from the file, or request the list if there is none."""
        from link.services.param.unpack import unpack

        self._file = None
        params = unpack(outcome.data) if outcome.done else outcome.problem
        if isinstance(params, str):
            self.client.fetch(now)
            return
        self.client.load(params)
        self._watch_fetch()

    def _watch_fetch(self) -> None:
        """Report how the fetch stands."""
        if self._fetch is None:
            return
        if self._file is not None:
            self._book.advance(self._fetch, *self._files().progress_of(self._file))
        elif self.client.fetching:
            self._book.advance(self._fetch, *self.client.progress)
        elif self.client.complete:
            self._book.accept(self._fetch, f"{len(self.client.params)} parameters")
            self._fetch = None
        elif self.client.problem is not None:
            self._book.fail(self._fetch, self.client.problem)
            self._fetch = None

    # ---- one ----

    def _begin_access(self, access: _Access, what: str, now: float) -> bool:
        if not self._book.begin(access.number, what):
            return False
        if access.name in self._access:
            self._book.refuse(access.number, f"{access.name} is being requested already", now, by_vehicle=False)
            return False
        self._access[access.name] = access
        return True

    def _set_known(self, name: str, now: float) -> None:
        access = self._access[name]
        assert access.wanted is not None
        access.before = self.client.params[name].value
        self.client.set(name, access.wanted, now)

    def _handle_outcomes(self, now: float) -> None:
        while outcomes := self.client.outcomes():  # a set behind a read may end at once
            for outcome in outcomes:
                self._handle_outcome(outcome, now)

    def _handle_outcome(self, outcome: ParamOutcome, now: float) -> None:
        access = self._access.get(outcome.name)
        if access is None:
            return
        if outcome.done and outcome.wanted is None and access.wanted is not None:
            self._set_known(outcome.name, now)
            return
        del self._access[outcome.name]
        self._end(access, outcome, now)

    def _end(self, access: _Access, outcome: ParamOutcome, now: float) -> None:
        if outcome.done:
            before = "" if access.before is None else f"was {value_text(access.before)}"
            self._book.accept(access.number, before)
        elif outcome.fault is not None:
            if outcome.fault == ParamErrorCode.READ_ONLY:
                self._book.keep(access.number, access.name)
            detail = self._fault_text(outcome)
            by_vehicle = outcome.wanted is not None and outcome.tries > 0
            self._book.refuse(access.number, detail, now, by_vehicle=by_vehicle, name=access.name, answer=outcome.fault)
        elif outcome.value is not None:
            self._book.keep(access.number, access.name)
            self._book.refuse(access.number, f"the vehicle keeps {value_text(outcome.value)}", now, name=access.name)
        else:
            self._book.fail(access.number, f"after {outcome.tries} tries")

    def _fault_text(self, outcome: ParamOutcome) -> str:
        """Return what a fault means; one of ours (never sent) names the type."""
        known = self.client.params.get(outcome.name)
        if outcome.tries == 0 and known is not None and outcome.wanted is not None:
            if value_fault(outcome.wanted, known.kind, bytewise=True) is None:  # only the cast to float32 changes it
                below, above = float32_neighbours(outcome.wanted)
                wanted = value_text(outcome.wanted)
                return f"float32 carries {value_text(below)} or {value_text(above)}, not {wanted}"
            return f"its type {param_type_name(known.kind)} cannot hold {value_text(outcome.wanted)}"
        return param_error_text(outcome.fault if outcome.fault is not None else ParamErrorCode.DOES_NOT_EXIST)

    # ---- waiting ----

    def _when_settled(self, step: Callable[[float], None], now: float) -> None:
        if self._identity.settled:
            self._settle()
            step(now)
        else:
            self._waiting.append(step)

    def _settle(self) -> None:
        self.client.bytewise = is_bytewise(self._autopilot(), self._identity.capabilities)


_TYPE_NAMES = {1: "UINT8", 2: "INT8", 3: "UINT16", 4: "INT16", 5: "UINT32", 6: "INT32", 7: "UINT64", 8: "INT64",
               9: "REAL32", 10: "REAL64"}  # fmt: skip


def param_type_name(kind: int) -> str:
    """Return the name of a MAV_PARAM_TYPE."""
    return _TYPE_NAMES.get(kind, f"type {kind}")
