"""How it looks: themes, colours, roles of colours, ASCII replacements.

To add or change:
- a meaning that has a colour: `groundstation/ui/look/roles.py`, `Role`, and its colour in each theme.
- a character that ASCII terminals lack: `groundstation/ui/look/ascii.py`.
"""
