"""A checkpoint of several ranks put together: the bytes of the file that one process writes (src/output/checkpoint_pieces.hpp)."""

import struct
import zlib

INDEX = b"barchan checkpoint index 2\n"
PIECE = b"barchan checkpoint piece 2\n"
ONE = b"barchan checkpoint 2\n"
HEAD = struct.Struct("<QII")  # bytes of the items, their CRC-32, 0


def items_of(data):
    """The bytes of each item of an archive, by name."""
    items, at = {}, 0
    while at < len(data):
        (length,) = struct.unpack_from("<I", data, at)
        name = data[at + 4:at + 4 + length].decode()
        width, count = struct.unpack_from("<QQ", data, at + 4 + length)
        at += 4 + length + 16
        items[name] = data[at:at + width * count]
        at += width * count
    return items


def pieces(file):
    """The files of the pieces that an index names; of a checkpoint in one file none."""
    data = file.read_bytes()
    if not data.startswith(INDEX):
        return []
    index = items_of(data[len(INDEX) + HEAD.size:])
    (number,) = struct.unpack("<Q", index["number"])
    return [file.parent / index["folder"].decode() / f"{number:06d}_{k:04d}" for k in range(len(index["pieces"]) // HEAD.size)]


def whole(file):
    """The bytes of a checkpoint in one file, whoever has written it."""
    data = file.read_bytes()
    if not data.startswith(INDEX):
        return data
    index = items_of(data[len(INDEX) + HEAD.size:])
    rows = [piece.read_bytes()[len(PIECE) + 16:] for piece in pieces(file)]
    places = struct.unpack(f"<{len(index['places of rows']) // 8}Q", index["places of rows"])
    sizes = struct.unpack(f"<{len(index['bytes of rows']) // 8}Q", index["bytes of rows"])
    at, before, parts = [0] * len(rows), 0, []
    for item, place in enumerate(places):
        parts.append(index["items"][before:place])
        before = place
        for rank, own in enumerate(rows):
            size = sizes[rank * len(places) + item]
            parts.append(own[at[rank]:at[rank] + size])
            at[rank] += size
    parts.append(index["items"][before:])
    items = b"".join(parts)
    return ONE + HEAD.pack(len(items), zlib.crc32(items), 0) + items
