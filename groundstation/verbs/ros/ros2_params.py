"""The parameters of the vehicle as the parameters of its node: `ros2 param list`, `get`, `set`, `describe`, `dump`."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping

from groundstation.ros.parameters import describe, matching, type_of, value_of, wanted_value
from groundstation.ros.vehicle import Values
from groundstation.vehicles.requests.requests import RequestState
from groundstation.verbs.session.session import VerbSession
from link.services.param.client import Param

MOST_NAMES = 2048
"""Names in one request that are answered."""


PARAMETER_SERVICES = {
    f"~/{name}": f"rcl_interfaces/srv/{kind}"
    for name, kind in (
        ("list_parameters", "ListParameters"),
        ("get_parameters", "GetParameters"),
        ("get_parameter_types", "GetParameterTypes"),
        ("describe_parameters", "DescribeParameters"),
        ("set_parameters", "SetParameters"),
        ("set_parameters_atomically", "SetParametersAtomically"),
    )
}
"""Service -> its type."""

Serve = Callable[[Values], Awaitable[Values]]
"""Takes a request, returns the response."""


def parameter_services(session: VerbSession) -> dict[str, Serve]:
    """Return what serves each of PARAMETER_SERVICES; all parameters are fetched when the first of them is called."""
    served = _Served(session)
    rows = (
        served.list_names, served.get, served.get_types, served.describe, served.set_each, served.set_atomically
    )  # fmt: skip
    return dict(zip(PARAMETER_SERVICES, rows, strict=True))


class _Served:
    """The services."""

    def __init__(self, session: VerbSession) -> None:
        self._session = session
        self._one = asyncio.Lock()
        self._fetched = False

    async def list_names(self, request: Values) -> Values:
        params = await self._params()
        return {"result": {"names": matching(params, request["prefixes"]), "prefixes": []}}

    async def get(self, request: Values) -> Values:
        params = await self._params()
        return {"values": [value_of(params.get(name)) for name in request["names"][:MOST_NAMES]]}

    async def get_types(self, request: Values) -> Values:
        params = await self._params()
        return {"types": [type_of(params.get(name)) for name in request["names"][:MOST_NAMES]]}

    async def describe(self, request: Values) -> Values:
        params = await self._params()
        return {"descriptors": [describe(name, params.get(name)) for name in request["names"][:MOST_NAMES]]}

    async def set_each(self, request: Values) -> Values:
        return {"results": [await self._set(each) for each in request["parameters"][:MOST_NAMES]]}

    async def set_atomically(self, request: Values) -> Values:
        if len(request["parameters"]) != 1:
            return {"result": _result("a vehicle sets parameters one after the other: set one, or use set_parameters")}
        return {"result": await self._set(request["parameters"][0])}

    async def _params(self) -> Mapping[str, Param]:
        requests = self._session.services.params
        async with self._one:
            if not self._fetched:
                report = await self._session.request(requests.fetch)
                self._fetched = report.state is RequestState.ACCEPTED
        return requests.client.params

    async def _set(self, parameter: Values) -> Values:
        name = parameter["name"]
        wanted = wanted_value(parameter["value"], name, await self._params())
        if isinstance(wanted, str):
            return _result(wanted)
        requests = self._session.services.params
        async with self._one:
            report = await self._session.request(lambda number, now: requests.set(number, name, wanted, now))
        return _result("" if report.state is RequestState.ACCEPTED else report.text)


def _result(fault: str) -> Values:
    return {"successful": not fault, "reason": fault}
