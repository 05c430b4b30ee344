"""Video: where pictures come from, and the program of others that decodes them in a bounded process.

To add or change:
- a kind of source: `groundstation/video/source.py`, `KINDS`, and what ffmpeg is told about it in
  `groundstation/video/ffmpeg_command.py`, `_INPUTS`.
"""
