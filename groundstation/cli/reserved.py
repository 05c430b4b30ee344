"""Names that no endpoint may have."""

from __future__ import annotations


class ReservedNames:
    """The names of verbs and programs. Their tables are loaded when the first one is looked up."""

    def __contains__(self, name: object) -> bool:
        """Return whether it is the name of a verb or program."""
        from groundstation.cli.verb_help import EVERY_VERB

        return name in EVERY_VERB


RESERVED = ReservedNames()
