"""Voice: says what changes of the vehicle, and rings the bell for what must not be missed."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from groundstation.speech.announcements import Announcement, Priority, SpokenState, StateAnnouncer
from groundstation.speech.programs import find_program
from groundstation.speech.speaker import Speaker


class Voice:
    """`ring` rings the bell of the terminal; None: it does not ring."""

    def __init__(self, speaker: Speaker | None, ring: Callable[[], None] | None) -> None:
        self._speaker, self._ring = speaker, ring
        self._announcer = StateAnnouncer()

    @classmethod
    def open(cls, *, speak: bool, ring: Callable[[], None] | None) -> Voice:
        """Return one that speaks, if a program for that is there."""
        program = find_program() if speak else None
        return cls(Speaker(program) if program is not None else None, ring)

    def update(self, state: SpokenState | None, more: Iterable[Announcement] = ()) -> None:
        """Say what has changed, and `more`."""
        for each in [*self._announcer.update(state), *more]:
            self.say(each)

    def say(self, announcement: Announcement) -> None:
        """Say it; ring if it is urgent."""
        if self._speaker is not None:
            self._speaker.say(announcement)
        if self._ring is not None and announcement.priority is Priority.URGENT:
            self._ring()

    @property
    def speaks(self) -> bool:
        """Whether there is a program that speaks."""
        return self._speaker is not None

    @property
    def muted(self) -> bool:
        """Whether it would speak, and is silent."""
        return self._speaker is not None and self._speaker.muted

    def switch_mute(self) -> bool:
        """Be silent, or speak again; return whether it is silent now."""
        if self._speaker is None:
            return True
        self._speaker.mute(not self._speaker.muted)
        self.say(Announcement(Priority.CHANGE, "speech is on"))  # not heard while it is muted
        return self._speaker.muted

    def close(self) -> None:
        """End what is being said."""
        if self._speaker is not None:
            self._speaker.close()
