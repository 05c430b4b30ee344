"""The stream of a camera on the ground: received by a process of its own, passed on to screens, recorded, read again.

To add or change:
- what is written for each picture: `groundstation/stream/video_file.py`.
- what decoders of screens get: `WholePictures` in `groundstation/stream/whole_pictures.py`.
- another coding than H.264: a class like `Depacketizer` in `groundstation/stream/rtp.py`.
"""
