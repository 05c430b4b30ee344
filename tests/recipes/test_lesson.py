"""Recipe: a lesson of the course, in one file."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

LESSON = """\
title = "There and back"
text = "Drive forward, and come back."
why = ["One.", "Two.", "Three."]

[[steps]]
task = "Hold `drive.forward` until the rover has gone 1 m."
check = "drove_forward"
value = 1
"""
SHOW_IT = """
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.learn.attempt import Attempt
from groundstation.learn.course import load_course
from groundstation.ui.learn.lesson_dock import LessonDock

chosen = load_course()[-1]
dock = LessonDock(chosen.heading, Attempt(chosen.lesson))
print(dock.value((80, 24), Keymap("standard", KEYMAPS["standard"])).tasks[0].text)
"""


def test_a_lesson(tree: Tree) -> None:
    file = "groundstation/learn/lessons/11_there_and_back.toml"
    tree.write(file, LESSON)
    tree.check_recipe("a lesson of the course")
    assert "11  -       There and back" in tree.run("groundstation", "learn", "list")
    assert "Hold [i] until the rover has gone 1 m." in tree.run_script(SHOW_IT)
    tree.replace(file, "drove_forward", "drove_foward")
    said = tree.run("groundstation", "learn", "11", fails=True)
    assert f"{file}:7: steps[0].check: there is no check 'drove_foward'; did you mean drove_forward or " in said
