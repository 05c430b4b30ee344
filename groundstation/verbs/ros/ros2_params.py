"""The parameters of the vehicle as the parameters of its node: `ros2 param list`, `get`, `set`, `describe`, `dump`."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from groundstation.ros.parameters import describe, matching, type_of, value_of, wanted_value
from groundstation.ros.vehicle import Values
from groundstation.vehicles.requests.requests import RequestState
from groundstation.verbs.session.session import VerbSession
from link.services.param.client import Param

if TYPE_CHECKING:
    from groundstation.ros2.node import Ros2Node

MOST_NAMES = 2048
"""Names in one request that are answered."""


def add_parameter_services(node: Ros2Node, session: VerbSession) -> None:
    """Add the six services; all parameters are fetched when the first of them is called."""
    served = _Served(session)
    for name, kind, serve in (
        ("list_parameters", "ListParameters", served.list_names),
        ("get_parameters", "GetParameters", served.get),
        ("get_parameter_types", "GetParameterTypes", served.get_types),
        ("describe_parameters", "DescribeParameters", served.describe),
        ("set_parameters", "SetParameters", served.set_each),
        ("set_parameters_atomically", "SetParametersAtomically", served.set_atomically),
    ):
        node.add_service(f"~/{name}", f"rcl_interfaces/srv/{kind}", serve)


class _Served:
    """The services."""

    def __init__(self, session: VerbSession) -> None:
        self._session = session
        self._one = asyncio.Lock()
        self._fetched = False

    async def list_names(self, request: Any) -> Values:
        params = await self._params()
        return {"result": {"names": matching(params, request.prefixes), "prefixes": []}}

    async def get(self, request: Any) -> Values:
        params = await self._params()
        return {"values": [value_of(params.get(name)) for name in request.names[:MOST_NAMES]]}

    async def get_types(self, request: Any) -> Values:
        params = await self._params()
        return {"types": [type_of(params.get(name)) for name in request.names[:MOST_NAMES]]}

    async def describe(self, request: Any) -> Values:
        params = await self._params()
        return {"descriptors": [describe(name, params.get(name)) for name in request.names[:MOST_NAMES]]}

    async def set_each(self, request: Any) -> Values:
        return {"results": [await self._set(each) for each in request.parameters[:MOST_NAMES]]}

    async def set_atomically(self, request: Any) -> Values:
        if len(request.parameters) != 1:
            return {"result": _result("a vehicle sets parameters one after the other: set one, or use set_parameters")}
        return {"result": await self._set(request.parameters[0])}

    async def _params(self) -> Mapping[str, Param]:
        requests = self._session.services.params
        async with self._one:
            if not self._fetched:
                report = await self._session.request(requests.fetch)
                self._fetched = report.state is RequestState.ACCEPTED
        return requests.client.params

    async def _set(self, parameter: Any) -> Values:
        wanted = wanted_value(parameter.value, parameter.name, await self._params())
        if isinstance(wanted, str):
            return _result(wanted)
        requests = self._session.services.params
        async with self._one:
            report = await self._session.request(lambda number, now: requests.set(number, parameter.name, wanted, now))
        return _result("" if report.state is RequestState.ACCEPTED else report.text)


def _result(fault: str) -> Values:
    return {"successful": not fault, "reason": fault}
