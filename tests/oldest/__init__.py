"""The tests with the oldest versions of all packages that pyproject.toml allows: `python -m tests.oldest`."""
