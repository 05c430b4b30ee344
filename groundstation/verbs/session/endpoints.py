"""Where a verb without a station finds its vehicle. What reads the config file is imported only where that matters."""

from __future__ import annotations

import time
from collections.abc import Callable, Container, Mapping, Sequence
from typing import TYPE_CHECKING

from groundstation.config.defaults import DEFAULT_ENDPOINT

if TYPE_CHECKING:
    from groundstation.config.config_file import ConfigError
    from groundstation.recent.recent_file import RecentFile
    from link.transport.transport import LinkError


def config_error() -> type[ConfigError]:
    """Return the class of mistakes in the config file."""
    from groundstation.config.config_file import ConfigError

    return ConfigError


def link_error() -> type[LinkError]:
    """Return the class of links that cannot be opened; a verb through a station loads no links."""
    from link.transport.transport import LinkError

    return LinkError


def choose_endpoints(
    texts: Sequence[str] | None,
    config: str | None,
    environment: Mapping[str, str],
    recent: RecentFile | None = None,
    note: Callable[[str], None] = lambda _: None,
    reserved: Container[str] = (),
) -> list[str]:
    """Return the endpoints of -e, of MAVHELM_ENDPOINT, of the config file, or the one used last.

    The config file is read only where it matters: a mistake in it does not keep a verb from a vehicle that -e names.
    `note` gets what is wrong with the file of recent endpoints; `reserved` are words that no endpoint may have as its
    name. Raises ConfigError, EndpointError.
    """
    if texts and all(":" in text for text in texts):
        return list(texts)
    from groundstation.config.effective import environment_endpoints, load_config, merge, resolve_endpoints

    texts = texts or environment_endpoints(environment)
    if texts and all(":" in text for text in texts):
        return list(texts)
    effective = merge(load_config(config, environment, reserved), environment, {"open": texts} if texts else {})
    if not texts and "open" not in effective.sources:
        return [_used_last(recent or _recent_file(), note)]
    return resolve_endpoints(effective.settings.open, effective.settings)


def _used_last(recent: RecentFile, note: Callable[[str], None]) -> str:
    last = recent.load().last
    if recent.warning:
        note(recent.warning)
    return last or DEFAULT_ENDPOINT


def remember(endpoints: Sequence[str], vehicle: str) -> None:
    """Note the endpoints as used; `vehicle` was heard there."""
    _recent_file().update(lambda known: known.add_all(endpoints, time.time(), vehicle))


def _recent_file() -> RecentFile:
    from groundstation.recent.recent_file import RecentFile

    return RecentFile()
