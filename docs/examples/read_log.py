"""Count the messages of a telemetry log and print its texts: `python read_log.py drive.tlog`."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

from dialects import codec
from dialects.messages import StatusText, decode_text
from link.protocol.framer import Framer
from link.tlog.tlog import read_records


def main() -> None:
    """Print the texts with their time, then how many messages of each kind the log has."""
    counts: Counter[str] = Counter()
    began = 0
    for record in read_records(Path(sys.argv[1]).read_bytes()):
        began = began or record.microseconds
        for message_id, _, _, _, raw in Framer(stream=False).feed(record.raw, 0.0):
            message = codec.decode_frame(message_id, raw)
            counts[message.get_type()] += 1
            if isinstance(message, StatusText):
                print(f"{(record.microseconds - began) / 1e6:8.3f} s  {decode_text(message)}")
    for name, count in counts.most_common():
        print(f"{count:8}  {name}")


if __name__ == "__main__":
    main()
