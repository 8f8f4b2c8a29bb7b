"""Writes an unsorted MDF 4 file, as loggers write one while the bus runs: frames of changing length and error frames in the order of time.

Neither asammdf nor python-can writes such a file. Source of the layout: ASAM MDF 4.1, blocks ID, HD, FH, DG, CG, CN, SI, TX and DT.
"""

import pathlib
import struct

FRAME, ERROR, DATA = 1, 2, 3
# Name, offset in the record, bytes, type of channel (0 value, 1 of changing length, 2 time), type of number (0 unsigned, 4 float, 10 bytes).
FRAME_FIELDS = [
    ("time", 0, 8, 2, 4),
    ("CAN_DataFrame", 8, 20, 0, 10),
    ("CAN_DataFrame.ID", 8, 4, 0, 0),
    ("CAN_DataFrame.IDE", 12, 1, 0, 0),
    ("CAN_DataFrame.BusChannel", 13, 1, 0, 0),
    ("CAN_DataFrame.EDL", 14, 1, 0, 0),
    ("CAN_DataFrame.BRS", 15, 1, 0, 0),
    ("CAN_DataFrame.DLC", 16, 1, 0, 0),
    ("CAN_DataFrame.DataLength", 17, 1, 0, 0),
    ("CAN_DataFrame.DataBytes", 20, 8, 1, 10),
]
ERROR_FIELDS = [("time", 0, 8, 2, 4), ("CAN_ErrorFrame", 8, 4, 0, 10), ("CAN_ErrorFrame.ID", 8, 4, 0, 0)]
FD_LENGTHS = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64]


class Blocks:
    """Blocks one after the other, from the last that nobody links to to the first."""

    def __init__(self):
        self.bytes = bytearray(64 + 104)

    def add(self, name, links, data=b"", at=None):
        content = struct.pack("<4s4xQQ", name, 24 + 8 * len(links) + len(data), len(links)) + struct.pack(f"<{len(links)}Q", *links) + data
        if at is not None:
            self.bytes[at : at + len(content)] = content
            return at
        self.bytes += bytes(-len(self.bytes) % 8)
        at = len(self.bytes)
        self.bytes += content
        return at

    def text(self, text):
        raw = text.encode() + b"\0"
        return self.add(b"##TX", [], raw + bytes(-len(raw) % 8))

    def channels(self, fields, data_group):
        """The channels of a group: time, then the frame with its fields below it."""
        following = 0
        for name, offset, size, kind, number in reversed(fields[2:]):
            following = self.channel(following, 0, name, offset, size, kind, number, data_group if kind == 1 else 0)
        name, *rest = fields[1]
        frame = self.channel(0, following, name, *rest, 0)
        name, *rest = fields[0]
        return self.channel(frame, 0, name, *rest, 0)

    def channel(self, following, below, name, offset, size, kind, number, data):
        links = [following, below, self.text(name), 0, 0, data, self.text("s") if kind == 2 else 0, 0]
        content = struct.pack("<4B4I2BH6d", kind, int(kind == 2), number, 0, offset, 8 * size, 0, 0, 0, 0, 0, *[0.0] * 6)
        return self.add(b"##CN", links, content)


def group(number, count, size):
    """The content of a group of frames on a bus."""
    return struct.pack("<QQHH4xII", number, count, 0b110, ord("."), size, 0)


def write(messages, path):
    """Writes messages of python-can in their order."""
    records, payloads, frames, errors = bytearray(), 0, 0, 0
    begins = messages[0].timestamp
    for message in messages:
        time_s = message.timestamp - begins
        if message.is_error_frame:
            records += struct.pack("<BdI", ERROR, time_s, 0)
            errors += 1
            continue
        data = bytes(message.data)
        code = next(code for code, length in enumerate(FD_LENGTHS) if length >= len(data))
        flags = (message.is_extended_id, 1, message.is_fd, message.bitrate_switch, code, len(data), 0)
        records += struct.pack("<BdI7BxQ", FRAME, time_s, message.arbitration_id, *map(int, flags), payloads)
        records += struct.pack("<BI", DATA, len(data)) + data
        payloads += 4 + len(data)
        frames += 1
    blocks = Blocks()
    data_at = blocks.add(b"##DT", [], bytes(records))
    source = blocks.add(b"##SI", [blocks.text("CAN"), 0, 0], struct.pack("<3B5x", 2, 2, 0))
    of_data = blocks.add(b"##CG", [0] * 6, struct.pack("<QQHH4xQ", DATA, frames, 1, 0, payloads))
    of_errors = blocks.add(
        b"##CG", [of_data, blocks.channels(ERROR_FIELDS, 0), blocks.text("CAN1"), source, 0, 0], group(ERROR, errors, 12)
    )
    of_frames = blocks.add(
        b"##CG", [of_errors, blocks.channels(FRAME_FIELDS, of_data), blocks.text("CAN1"), source, 0, 0], group(FRAME, frames, 28)
    )
    data_group = blocks.add(b"##DG", [0, of_frames, data_at, 0], struct.pack("<B7x", 1))
    history = blocks.add(b"##FH", [0, blocks.text("oleo")], struct.pack("<QhhB3x", int(begins * 1e9), 0, 0, 0))
    header = struct.pack("<Qhh4B2d", int(begins * 1e9), 0, 0, 0, 0, 0, 0, 0.0, 0.0)
    blocks.add(b"##HD", [data_group, history, 0, 0, 0, 0], header, at=64)
    blocks.bytes[:64] = struct.pack("<8s8s8s4xH30xHH", b"MDF     ", b"4.10    ", b"oleo    ", 410, 0, 0)
    pathlib.Path(path).write_bytes(blocks.bytes)
