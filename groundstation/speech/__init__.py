"""Without looking: changes as spoken announcements and a bell; docs/accessibility.md.

To add:
- something that is said: a rule in `groundstation/speech/announcements.py`.
- a speech program: its row in `groundstation/speech/programs.py`.
"""
