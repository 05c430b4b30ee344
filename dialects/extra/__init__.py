"""A further dialect from a user's XML file, which adds messages to the built-in ones when a program starts.

To add or change:
- what a user's dialect file may contain: `dialects/extra/attributes.py`, and `_CHILDREN` in
  `dialects/extra/definition_file.py`.
"""
