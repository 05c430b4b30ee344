"""Settings of the ground station: their table, the file groundstation.toml, and which value wins.

To add or change:
- a setting of the ground station: a field with a docstring in `groundstation/config/settings.py`; with `Option` it
  has an option, too.
- a theme: its name in `groundstation/config/settings.py`, `ThemeName`; its row in `groundstation/ui/look/themes.py`,
  `THEMES`.
"""
