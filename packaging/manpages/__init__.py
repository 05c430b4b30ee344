"""Manual pages, made from the same tables and parsers as --help: `python -m manpages FOLDER` writes them.

They are written where a package is built, and not kept in the repository. To add a program: `pages.py`, `build_pages`.
"""
