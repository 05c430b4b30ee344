"""The Debian package: wheels unpacked into a private environment, with service, user, rules for devices and manuals.

`python -m deb` with `packaging` on the path (make deb) assembles it; nothing is compiled, neither here nor where it is
installed. To add:
- a distribution: `target.py`, `SUITES`; a processor: `MACHINES` there
- a file of the package: `tree.py`
- an exception from lintian's rules: `lintian-overrides`, with its reason
"""
