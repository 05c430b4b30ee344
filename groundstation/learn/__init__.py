"""Lessons on the real screens: a text, tasks, and a check of what the rover did.

To add or change:
- a lesson of the course: a TOML file in `lessons/`, beginning with its number; docs/teach.md has the keys.
- what a lesson may check: a row in `conditions.py`, `CONDITIONS`; what it needs to know of the rover, in `deeds.py`.
- what a computer must have for a lesson: a row in `requirements.py`, `REQUIREMENTS`.
"""
