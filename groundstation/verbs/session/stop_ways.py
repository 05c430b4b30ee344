"""The way of a stop to its vehicle: through a station that answers, else by links of its own, and by either in turn.

Where several stations run, a stop goes through each of them: which of them has the vehicle is not known.

A station that hangs (SIGSTOP, a loop, a full socket) must not keep a stop from its vehicle. A port or cable that it
holds cannot be opened beside it; then the stop waits for its end or for its answer, whichever comes first.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Sequence

from groundstation.station_socket.connect import running_stations
from groundstation.station_socket.folder import FolderError
from groundstation.verbs.client.station_choice import AUTO, NEVER, SeveralStationsError, StationLostError
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.session.endpoints import link_error

STOP_WITHIN = 0.5
"""s for a station to answer before a stop goes without it: it may hang."""

AGAIN = 0.2
"""s between two rounds of both ways."""

Attempt = Callable[[str, Sequence[str]], Awaitable[int]]
"""Takes a value of --station, and the endpoints; none: those of the command line. Returns the exit code of the verb."""


async def stop_by_any_way(attempt: Attempt, note: Callable[[str], None], until: float) -> int:
    """Return the exit code of the first attempt that has a way. `note` gets why another way is tried.

    Raises VerbError, EndpointError, LinkError, after `until` (the time of the loop) if all ways are closed.
    """
    told: set[str] = set()

    def tell(text: str) -> None:
        if text not in told:
            note(text)
        told.add(text)

    while True:
        try:
            return await _try_both(attempt, tell)
        except link_error() as closed:
            pids = _stations()
            if not pids or asyncio.get_running_loop().time() >= until:
                raise
            tell(f"{closed}; trying on. If station {pids[0]} hangs: kill -9 {pids[0]}")
        await asyncio.sleep(AGAIN)


async def _try_both(attempt: Attempt, tell: Callable[[str], None], through: str = AUTO) -> int:
    """Try a station that runs, or each of several, then links of its own. Raises what `attempt` raises."""
    try:
        return await attempt(through, ())
    except SeveralStationsError as several:
        tell(f"stations {', '.join(map(str, several.pids))} run here; this stop goes through each")
        return await _try_each(attempt, tell, several.pids)
    except StationLostError as lost:
        tell(f"{lost}; this stop opens links of its own")
        return await attempt(NEVER, lost.endpoints)


async def _try_each(attempt: Attempt, tell: Callable[[str], None], pids: Sequence[int]) -> int:
    """Try all stations at once. Return the code of all; one without such a vehicle says nothing about the others.

    Raises what `attempt` raises if none has a way.
    """
    tries = (_try_both(attempt, tell, str(pid)) for pid in pids)
    ended = await asyncio.gather(*tries, return_exceptions=True)
    codes = [each for each in ended if not isinstance(each, BaseException)]
    errors = [each for each in ended if isinstance(each, BaseException)]
    if not codes:
        raise errors[0]
    for error in errors:
        tell(str(error))
    return max((code for code in codes if code != ExitCode.NO_VEHICLE), default=ExitCode.NO_VEHICLE)


def _stations() -> list[int]:
    try:
        return running_stations()
    except FolderError:
        return []
