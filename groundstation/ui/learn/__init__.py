"""The pane of a lesson, which is docked beside every screen: `lesson_dock.py` joins it to an attempt, `pane.py` draws.

groundstation/learn has the lessons and their checks.
"""
