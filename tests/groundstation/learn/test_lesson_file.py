"""Lesson files: those of the course are right, and each mistake in one is named with its line and the remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.learn.conditions import CONDITIONS
from groundstation.learn.course import load_course, load_own
from groundstation.learn.lesson_file import LessonError, parse_lesson

ROOT = Path(__file__).parents[3]

GOOD = """title = "Mine"
screen = "drive"
text = "Drive, and look."
why = ["one", "two", "three"]

[[simulators]]
delay = 100

[[steps]]
task = "Hold `drive.forward`."
check = "drove_forward"
value = 1

[[steps]]
task = "Press `vehicle.arm`."
check = "disarmed"

[[steps.hints]]
check = "waited"
value = 9
text = "Look at the first line."
"""


def test_the_course_has_ten_lessons_with_their_screens() -> None:
    course = load_course()
    assert [each.id for each in course] == [str(number) for number in range(1, 11)]
    assert {each.lesson.screen for each in course} == {"drive", "links", "map"}


def test_a_lesson_of_a_teacher_loads(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(GOOD)
    own = load_own(file)
    assert (own.heading, own.id) == ("Mine", str(file))
    assert own.lesson.simulators[0].options == ("--system", "1", "--sim-seed", "1", "--delay=100")
    assert [step.check for step in own.lesson.steps] == ["drove_forward", "disarmed"]


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('screen = "drive"', 'screen = "driv"', "mine.toml:2: screen: there is no screen 'driv'; did you mean drive?"),
        ('title = "Mine"', 'titel = "Mine"', "mine.toml:1: titel: unknown key; did you mean title"),
        ('check = "disarmed"', 'check = "disarm"', "mine.toml:16: steps[1].check: there is no check 'disarm'; did you"),
        ("value = 9", "", "mine.toml:19: steps[1].hints[0].check: waited needs value = a number above 0, in s"),
        ('"three"]', '"three", "4"]', "mine.toml:4: why: has 4 lines; write 3"),
        ("Drive, and look.", "word " * 121, "mine.toml:3: text: has 121 words; write 1 to 120"),
        ("`drive.forward`", "`drive.foward`", "mine.toml:10: steps[0].task: there is no action `drive.foward`; did"),
        ("delay = 100", 'delay = "long"', "mine.toml:7: simulators[0].delay: must be a number, not text"),
        ("delay = 100", "delay = 99999", "mine.toml:7: simulators[0].delay: must be at most 60000"),
        ("value = 1\n", 'value = 1\nname = "X"\n', "mine.toml:13: steps[0].name: drove_forward takes no name"),
        (
            'check = "waited"',
            'check = "opened_message"',
            "steps[1].hints[0].check: opened_message needs name",
        ),
        ("why = [", "requires = ['ros7']\nwhy = [", "mine.toml:4: requires: 'ros7' is not known; did you mean ros1"),
        ("[[simulators]]", "[[simulators]", "mine.toml: "),
    ],
)
def test_a_mistake_is_named_with_file_line_and_remedy(old: str, new: str, says: str) -> None:
    assert old in GOOD
    with pytest.raises(LessonError) as found:
        parse_lesson(GOOD.replace(old, new, 1), "mine.toml")
    assert says in str(found.value)
    assert "\n" not in str(found.value)


def test_what_is_no_lesson_file_is_one_line(tmp_path: Path) -> None:
    for path, says in (
        (tmp_path, "is a directory"),
        (tmp_path / "no.toml", "No such file"),
        (Path("/dev/zero"), "is"),
    ):
        with pytest.raises(LessonError, match=says):
            load_own(path)


def test_the_page_for_teachers_has_each_check_and_loads() -> None:
    page = (ROOT / "docs" / "teach.md").read_text()
    for name, row in CONDITIONS.items():
        assert f"| `{name}` | {row.help} | {row.unit} | {row.named} |" in page
    assert parse_lesson(page.split("```toml\n")[1].split("```")[0], "page").title == "Around the table"
