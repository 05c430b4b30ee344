"""The processes of the station and of a replay: the loop around each, and their ends of the pipes to screens."""

from link.runtime import without_openssl

without_openssl.load()
