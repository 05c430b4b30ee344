"""The processes of the station and of a replay: the loop around each, and their ends of the pipes to screens."""

from link.runtime import asyncio_without_ssl

asyncio_without_ssl.load()
