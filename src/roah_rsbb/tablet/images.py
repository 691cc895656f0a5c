"""Images of maps: PGM read and PNG written, as browsers show no PGM. Only the standard library is needed."""

import struct
import zlib
from typing import List, NamedTuple, Tuple

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# More than any map of a building; phones show no larger images.
MAX_SIDE = 8192
_LARGEST_PGM_VALUE = 65535
_PLAIN, _RAW = b"P2", b"P5"
_GREY, _EIGHT_BITS = 0, 8


class BadImage(ValueError):
    """An image that cannot be shown; the text says why."""


class Grey(NamedTuple):
    """A grey image: rows from the top, each pixel a byte, 255 is white."""

    width: int
    height: int
    pixels: bytes


def read_pgm(data: bytes) -> Grey:
    """A PGM file, plain (P2) or raw (P5), of up to 16 bits; `BadImage` for anything else."""
    if data[:2] not in (_PLAIN, _RAW):
        raise BadImage("it is no PGM file (those begin with P2 or P5)")
    (width, height, highest), body = _header(data)
    check_size(width, height)
    if not 1 <= highest <= _LARGEST_PGM_VALUE:
        raise BadImage(f"its highest value is {highest}, and a PGM file has 1 to {_LARGEST_PGM_VALUE}")
    count = width * height
    values = _plain(data, body, count) if data[:2] == _PLAIN else _raw(data, body, count, highest)
    if len(values) < count:
        raise BadImage(f"it ends after {len(values)} of {count} pixels")
    if highest == 255:
        return Grey(width, height, bytes(min(value, 255) for value in values) if data[:2] == _PLAIN else bytes(values))
    return Grey(width, height, bytes(min(value, highest) * 255 // highest for value in values))


def _header(data: bytes) -> Tuple[Tuple[int, int, int], int]:
    """Width, height and highest value, and where the pixels begin. Comments reach from # to the line's end."""
    numbers: List[int] = []
    at = 2
    while len(numbers) < 3:
        while data[at:at + 1].isspace():
            at += 1
        if data[at:at + 1] == b"#":
            while at < len(data) and data[at:at + 1] not in (b"\n", b"\r"):
                at += 1
            continue
        start = at
        while data[at:at + 1].isdigit() and at - start < 10:
            at += 1
        if start == at:
            raise BadImage("its header (width, height, highest value) is broken")
        numbers.append(int(data[start:at]))
    return (numbers[0], numbers[1], numbers[2]), at + 1  # one white space ends the header


def _raw(data: bytes, body: int, count: int, highest: int):
    if highest < 256:
        return data[body:body + count]
    pairs = data[body:body + 2 * count]
    return struct.unpack(f">{len(pairs) // 2}H", pairs[:len(pairs) // 2 * 2])


def _plain(data: bytes, body: int, count: int) -> List[int]:
    try:
        values = [int(word) for word in data[body - 1:].split(maxsplit=count)[:count]]
    except ValueError:
        raise BadImage("one of its pixels is no number") from None
    if any(value < 0 for value in values):
        raise BadImage("one of its pixels is negative")
    return values


def check_size(width: int, height: int) -> None:
    """Raise `BadImage` for an image that is empty or too large."""
    if not (1 <= width <= MAX_SIDE and 1 <= height <= MAX_SIDE):
        raise BadImage(f"it has {width} x {height} pixels, and may have 1 to {MAX_SIDE} a side: crop or scale it")


def write_png(image: Grey) -> bytes:
    """A grey image as a PNG file."""
    rows = b"".join(
        b"\0" + image.pixels[row * image.width:(row + 1) * image.width] for row in range(image.height)
    )
    header = struct.pack(">IIBBBBB", image.width, image.height, _EIGHT_BITS, _GREY, 0, 0, 0)
    return PNG_SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(rows, 9)) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_size(data: bytes) -> Tuple[int, int]:
    """Width and height of a PNG file; `BadImage` if it is none."""
    if data[:8] != PNG_SIGNATURE or data[12:16] != b"IHDR" or len(data) < 24:
        raise BadImage("it is no PNG file")
    width, height = struct.unpack(">II", data[16:24])
    check_size(width, height)
    return width, height
