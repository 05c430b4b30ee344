"""Video in the terminal: the viewer of `mavhelm video`, which draws without Textual's screens.

To add or change:
- a key of the viewer: `groundstation/ui/video/viewer_keys.py`.
- what stands below the picture: `groundstation/ui/video/status_line.py`.
"""
