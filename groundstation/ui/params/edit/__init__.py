"""Editing of parameters: values being typed, pending changes, checks, files.

To add or change:
- why a parameter matters for stopping: `groundstation/ui/params/edit/reasons.py`, `REASONS`; what needs care while
  armed: `RISKY`.
"""
