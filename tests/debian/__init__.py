"""The Debian package in a bare Debian: installed, started, upgraded, purged. `python3 -m tests.debian FILE.deb`."""
