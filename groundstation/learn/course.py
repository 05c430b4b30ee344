"""The course: the lesson files that come with the program, in their order."""

from __future__ import annotations

from pathlib import Path

import msgspec

from groundstation.learn.lesson import Lesson
from groundstation.learn.lesson_file import load_lesson

FOLDER = Path(__file__).parent / "lessons"


class CourseLesson(msgspec.Struct, frozen=True):
    """A lesson with its place."""

    id: str
    """By which its progress is kept: its number, or the path of a file of one's own."""
    file: Path
    lesson: Lesson

    @property
    def heading(self) -> str:
        """Its number, if it has one, and its title."""
        return f"{self.id} {self.lesson.title}" if self.id.isdecimal() else self.lesson.title


def load_course() -> tuple[CourseLesson, ...]:
    """Return all lessons of the course. Raises LessonError."""
    files = sorted(FOLDER.glob("*.toml"))
    return tuple(CourseLesson(str(int(file.name[:2])), file, load_lesson(file)) for file in files)


def load_own(file: Path) -> CourseLesson:
    """Return a lesson of somebody's own. Raises LessonError."""
    path = file.expanduser().absolute()
    return CourseLesson(str(path), path, load_lesson(path))
