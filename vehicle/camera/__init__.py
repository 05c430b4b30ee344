"""The camera: its settings, who watches, and the process that captures, stamps, encodes and sends the pictures.

The daemon starts that process and writes to it without waiting; it has no other part in the video.

To add or change:
- a kind of camera: `vehicle/camera/settings.py`, `Kind`, and its words in `vehicle/camera/capture.py`, `CAPTURES`.
- what is sent beside ffmpeg's packets: `vehicle/camera/copies.py`; `groundstation/stream/copies.py` takes it.
- what the simulator draws: `vehicle/camera/scene.py`.
"""
