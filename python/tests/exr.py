"""Reads the pictures that the program writes: OpenEXR, scan lines of 32-bit floats, ZIP in blocks of 16 rows."""

import struct
import zlib

import numpy as np


def read(path):
    """Channels by name, (height, width) each."""
    data = path.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01"
    at, attributes = 8, {}
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), end + 1
        end = data.index(b"\0", at)
        size = struct.unpack_from("<i", data, end + 1)[0]
        attributes[name] = data[end + 5 : end + 5 + size]
        at = end + 5 + size
    names, channels = [], attributes["channels"]
    while channels[0]:
        end = channels.index(b"\0")
        names.append(channels[:end].decode())
        assert struct.unpack_from("<i", channels, end + 1)[0] == 2
        channels = channels[end + 17 :]
    assert attributes["compression"] == b"\x03"
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    image = {name: np.empty((height, width), "f4") for name in names}
    offsets = struct.unpack_from(f"<{-(-height // 16)}Q", data, at + 1)
    for offset in offsets:
        first, size = struct.unpack_from("<2i", data, offset)
        block, rows = data[offset + 8 : offset + 8 + size], min(16, top + height - first)
        whole = 4 * width * rows * len(names)
        if size < whole:
            # Differences to the byte before, and bytes of even places before those of odd ones.
            packed = np.frombuffer(zlib.decompress(block), "u1").astype("i8")
            packed[1:] -= 128
            plain = (np.cumsum(packed) % 256).astype("u1")
            block = np.empty(whole, "u1")
            block[0::2], block[1::2] = plain[: (whole + 1) // 2], plain[(whole + 1) // 2 :]
            block = block.tobytes()
        values = np.frombuffer(block, "<f4").reshape(rows, len(names), width)
        for number, name in enumerate(names):
            image[name][first - top : first - top + rows] = values[:, number]
    return image
