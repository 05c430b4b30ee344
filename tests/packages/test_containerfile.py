"""The image is made of files that `make wheels` makes, runs as a user of its own, and starts a program that exists."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
LINES = re.sub(r"\\\n", " ", (ROOT / "packaging/Containerfile").read_text()).splitlines()
STEPS = [line.split(maxsplit=1) for line in LINES if line and not line.startswith("#")]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_every_step_is_one_of_a_containerfile() -> None:
    known = {"FROM", "COPY", "RUN", "USER", "WORKDIR", "ENV", "EXPOSE", "CMD"}
    assert {name for name, _ in STEPS} == known
    assert STEPS[0][0] == "FROM"


def test_the_python_of_the_image_is_supported() -> None:
    [version] = re.findall(r"python:(3\.\d+)-", dict(STEPS)["FROM"])
    assert f"Programming Language :: Python :: {version}" in PROJECT["classifiers"]


def test_it_copies_what_make_wheels_makes() -> None:
    source, _ = dict(STEPS)["COPY"].split()
    assert f"-d {source}\n" in (ROOT / "Makefile").read_text()


def test_it_runs_a_program_as_a_user() -> None:
    steps = dict(STEPS)
    assert steps["USER"] != "root"
    assert f"useradd --create-home {steps['USER']}" in steps["RUN"]
    assert json.loads(steps["CMD"])[0] in PROJECT["scripts"]
