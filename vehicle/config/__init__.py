"""The configuration file rover.toml: reading, checking, schema and template.

To add or change:
- a key of rover.toml: a field with a docstring in `vehicle/config/config.py`.
"""
