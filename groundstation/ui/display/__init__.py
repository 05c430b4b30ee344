"""State that screens draw: snapshot, alerts, hints, running tasks, wrapped texts.

To add or change:
- a mark in the tab bar: `groundstation/ui/display/tab_marks.py`, `TAB_MARKS`.
"""
