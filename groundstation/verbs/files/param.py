"""`mavhelm param`: get, set, store and reset the parameters of a vehicle."""

from __future__ import annotations

import argparse
import asyncio
import fnmatch
from collections.abc import Iterable, Sequence

from dialects.enums import ParamErrorCode
from groundstation.natural_order import natural_key
from groundstation.vehicles.requests.param_requests import param_type_name
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.verbs.common.endings import wait_for_ends
from groundstation.verbs.common.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.common.nearest import describe_nearest
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import RequestStart, VerbSession
from link.services.param.client import Param
from link.services.param.float32 import value_text
from link.services.param.values import value_fault

WILDCARDS = "*?["
ANSWERED_WITHIN = 1.5
"""s for one parameter: 0.1 s over UDP, up to 1 s over 57600 baud."""


async def get(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Print parameters by name, or all that match a pattern."""
    if options.patterns and not any(set(WILDCARDS) & set(pattern) for pattern in options.patterns):
        return await _get_named(session, [_name(each) for each in options.patterns], output)
    code = await fetch(session, output)
    chosen = matching(session.services.params.client.params.values(), options.patterns)
    for param in chosen:
        _print(param, output)
    if options.patterns and not chosen:
        raise VerbError(ExitCode.DIFFERS, f"no parameter matches {' or '.join(options.patterns)}")
    return code


async def set_value(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Set one parameter; done when the vehicle reports the new value."""
    await session.need_only_vehicle(options.vehicle)
    name = _name(options.name)
    report = await _access(
        session, name, lambda number, now: session.services.params.set(number, name, options.value, now)
    )
    known = session.services.params.client.params.get(name)
    if report.state is RequestState.ACCEPTED and known is not None:
        output.line(f"{name} {value_text(known.value)} ({report.detail})")
    code = finish(session, report, output, param_id=name, param_value=known.value if known else None)
    client = session.services.params.client
    unfit = known is not None and value_fault(options.value, known.kind, bytewise=client.bytewise) is not None
    return ExitCode.USAGE if code == ExitCode.REFUSED and unfit else code  # unfit: it was never sent


async def store(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Have the vehicle store all parameters."""
    await session.need_only_vehicle(options.vehicle)
    return finish(
        session, await session.request(session.services.param_storage.store), output, "has stored its parameters"
    )


async def reset(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Have the vehicle reset all parameters to their defaults."""
    if not options.yes:
        raise VerbError(ExitCode.USAGE, "this resets ALL parameters of the vehicle; --yes does it")
    await session.need_only_vehicle(options.vehicle)
    return finish(
        session, await session.request(session.services.param_storage.reset), output, "has reset its parameters"
    )


# ---- common parts ----


async def _get_named(session: VerbSession, names: Sequence[str], output: Output) -> int:
    codes: set[int] = set()
    for name in names:
        try:
            report = await _read(session, name)
        except VerbError as error:
            output.error(str(error))
            codes.add(error.code)
            continue
        if report.state is RequestState.ACCEPTED:
            _print(session.services.params.client.params[name], output)
        else:
            output.error(f"{session.vehicle.name}: {report.text}")
        codes.add(ExitCode.DIFFERS if report.answer == ParamErrorCode.DOES_NOT_EXIST else code_of(report))
    return codes.pop() if len(codes) == 1 else ExitCode.PARTLY


async def _read(session: VerbSession, name: str) -> RequestReport:
    return await _access(session, name, lambda number, now: session.services.params.read(number, name, now))


async def _access(session: VerbSession, name: str, start: RequestStart) -> RequestReport:
    """Read or set a parameter. Raises VerbError for a name that the vehicle does not have.

    ArduPilot does not answer for such a name. Where no answer has come in ANSWERED_WITHIN, the list tells.
    """
    client = session.services.params.client
    asking = asyncio.ensure_future(session.request(start))
    requests = [asking]
    try:
        await asyncio.wait({asking}, timeout=ANSWERED_WITHIN)
        if asking.done():
            return await asking
        listing = asyncio.ensure_future(session.request(session.services.params.fetch))
        requests.append(listing)
        await asyncio.wait({asking, listing}, return_when=asyncio.FIRST_COMPLETED)
        listed = listing.done() and listing.result().state is RequestState.ACCEPTED
        if listed and name not in client.params:
            hint = describe_nearest(name, client.params)
            raise VerbError(ExitCode.DIFFERS, f"{session.vehicle.name}: it has no {name}{hint}")
        listing.cancel()
        return await asking
    finally:  # also where the verb is cancelled: it must not go on asking, or setting
        for each in requests:
            each.cancel()
        await wait_for_ends(requests)


async def fetch(session: VerbSession, output: Output) -> int:
    """Fetch all parameters; return PARTLY if some are missing. Raises VerbError if there are none."""
    report = await session.request(session.services.params.fetch)
    if report.state is RequestState.ACCEPTED:
        return ExitCode.DONE
    text = f"{session.vehicle.name}: {report.text}"
    if not session.services.params.client.params:
        raise VerbError(code_of(report), text)
    output.error(text)
    return ExitCode.PARTLY


def matching(params: Iterable[Param], patterns: Sequence[str]) -> list[Param]:
    """Return the parameters whose name matches one of the patterns, by name; without patterns all."""
    upper = [pattern.upper() for pattern in patterns] or ["*"]
    chosen = [param for param in params if any(fnmatch.fnmatchcase(param.name.upper(), each) for each in upper)]
    return sorted(chosen, key=lambda param: natural_key(param.name))


def _print(param: Param, output: Output) -> None:
    default = f"  # default {value_text(param.default)}" if param.default is not None and param.is_changed else ""
    output.line(f"{param.name:<16} {value_text(param.value)}{default}")
    output.record(
        param_id=param.name, param_value=param.value, param_type=param_type_name(param.kind), default=param.default
    )


def _name(text: str) -> str:
    """Return a name as vehicles write it: in capitals. Escaped bytes stay as they are."""
    return text if "\\x" in text else text.upper()


def count(number: int) -> str:
    """Return a number of parameters as text."""
    return "1 parameter" if number == 1 else f"{number} parameters"
