"""The map of a `map_server` YAML file: its image for browsers, and the positions of its pixels.

Pixels count from the top left corner of the image, u to the right and v downwards, as fractions of the image (0 to 1),
so a page may show it in any size. Metres are those of the map: `origin` is the position of the bottom left corner, and
the angle by which the image is rotated counter-clockwise around it. Browsers do not show PGM, so it is converted to
PNG here, with the standard library only.
"""

import math
import os
import re
import stat
import struct
import zlib
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import yaml

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
# Threshold of `map_server` if the file has none.
OCCUPIED = 0.65
# Longest side in pixels; phones cannot show larger images.
MAX_SIDE = 8192
_LARGEST_PGM_VALUE = 65535
_PLAIN, _RAW = b"P2", b"P5"
# Width, height and highest value. Comments reach from # to the end of line.
_HEADER = re.compile(3 * rb"(?:\s|#[^\r\n]*[\r\n])*(\d{1,10})(?!\d)")
_GREY, _EIGHT_BITS = 0, 8


class BadImage(ValueError):
    """The image cannot be shown. The text says why."""


class Grey(NamedTuple):
    """A grey image: rows from the top, each pixel a byte, 255 is white."""

    width: int
    height: int
    pixels: bytes


def read_pgm(data: bytes) -> Grey:
    """Read a PGM file, plain (P2) or raw (P5), of up to 16 bits; `BadImage` for anything else."""
    if data[:2] not in (_PLAIN, _RAW):
        raise BadImage("it is not a PGM file (P2 or P5)")
    header = _HEADER.match(data, 2)
    if header is None:
        raise BadImage("its header (width, height, highest value) is invalid")
    width, height, highest = map(int, header.groups())
    body = header.end() + 1  # one white space ends the header
    check_size(width, height)
    if not 1 <= highest <= _LARGEST_PGM_VALUE:
        raise BadImage(f"its highest value is {highest}, but must be 1 to {_LARGEST_PGM_VALUE}")
    count = width * height
    values = _plain_pixels(data, body, count) if data[:2] == _PLAIN else _raw_pixels(data, body, count, highest)
    if len(values) < count:
        raise BadImage(f"it ends after {len(values)} of {count} pixels")
    if highest == 255:
        return Grey(width, height, bytes(min(value, 255) for value in values) if data[:2] == _PLAIN else bytes(values))
    return Grey(width, height, bytes(min(value, highest) * 255 // highest for value in values))


def _raw_pixels(data: bytes, body: int, count: int, highest: int):
    if highest < 256:
        return data[body:body + count]
    pairs = data[body:body + 2 * count]
    return struct.unpack(f">{len(pairs) // 2}H", pairs[:len(pairs) // 2 * 2])


def _plain_pixels(data: bytes, body: int, count: int) -> List[int]:
    try:
        values = [int(word) for word in data[body - 1:].split(maxsplit=count)[:count]]
    except ValueError:
        raise BadImage("one of its pixels is not a number") from None
    if any(value < 0 for value in values):
        raise BadImage("one of its pixels is negative")
    return values


def check_size(width: int, height: int) -> None:
    """Raises `BadImage` for an image that is empty or too large."""
    if not (1 <= width <= MAX_SIDE and 1 <= height <= MAX_SIDE):
        raise BadImage(f"it has {width} x {height} pixels, but a side may have 1 to {MAX_SIDE}: crop or scale it")


def write_png(image: Grey) -> bytes:
    """Convert a grey image to a PNG file."""
    rows = b"".join(
        b"\0" + image.pixels[row * image.width:(row + 1) * image.width] for row in range(image.height)
    )
    header = struct.pack(">IIBBBBB", image.width, image.height, _EIGHT_BITS, _GREY, 0, 0, 0)
    return PNG_SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(rows, 9)) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_size(data: bytes) -> Tuple[int, int]:
    """Width and height of a PNG file; `BadImage` for other data."""
    if data[:8] != PNG_SIGNATURE or data[12:16] != b"IHDR" or len(data) < 24:
        raise BadImage("it is not a PNG file")
    width, height = struct.unpack(">II", data[16:24])
    check_size(width, height)
    return width, height


# -- maps -------------------------------------------------------------------------------------------

# Largest accepted files.
MAX_YAML_BYTES = 64 * 1024
MAX_IMAGE_BYTES = 64 * 1024 * 1024
_LONGEST_SHOWN = 80


class MapError(ValueError):
    """The map cannot be used. The text names the file and the remedy."""


class Map(NamedTuple):
    """A map for browsers."""

    png: bytes
    width: int  # pixels
    height: int  # pixels
    resolution: float  # metres per pixel
    origin: Tuple[float, float, float]  # metres, metres, radians
    negate: bool  # the image must be shown inverted
    walls: bytes = b""  # for each pixel 1: something is there; empty: not known, as with a PNG image

    @property
    def version(self) -> str:
        """Differs for each image, because browsers cache images by address."""
        return f"{zlib.crc32(self.png):08x}"

    def is_wall(self, u: float, v: float) -> bool:
        """Whether a point of the image is on a wall or on something else that a robot cannot be on."""
        if not self.walls:
            return False
        column, row = min(int(u * self.width), self.width - 1), min(int(v * self.height), self.height - 1)
        return bool(self.walls[row * self.width + column])

    def to_metres(self, u: float, v: float) -> Tuple[float, float]:
        """Convert a point of the image to a position."""
        right = u * self.width * self.resolution
        up = (1.0 - v) * self.height * self.resolution
        x, y, yaw = self.origin
        return (x + right * math.cos(yaw) - up * math.sin(yaw), y + right * math.sin(yaw) + up * math.cos(yaw))

    def to_image(self, x: float, y: float) -> Tuple[float, float]:
        """Convert a position to a point of the image; outside of it, fractions are outside 0 to 1."""
        origin_x, origin_y, yaw = self.origin
        east, north = x - origin_x, y - origin_y
        right = east * math.cos(yaw) + north * math.sin(yaw)
        up = north * math.cos(yaw) - east * math.sin(yaw)
        return right / (self.width * self.resolution), 1.0 - up / (self.height * self.resolution)


def load(path: str) -> Map:
    """Load the map of a `map_server` YAML file with a PGM or PNG image. Raises `MapError`."""
    try:
        # Load all values as text: PyYAML raises exceptions for some invalid numbers and dates.
        document = yaml.load(_read_file(path, MAX_YAML_BYTES), Loader=yaml.BaseLoader)
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        if isinstance(error, MapError):
            raise
        raise MapError(f"{path}: invalid YAML: {' '.join(str(error).split())}") from None
    if not isinstance(document, dict):
        raise MapError(f"{path}: found no keys; expected image, resolution and origin, as map_saver writes them")
    resolution = _number(document.get("resolution"))
    if resolution is None or not 1e-4 <= resolution <= 10.0:
        raise MapError(f"{path}: resolution is {_shown(document, 'resolution')}; expected metres per pixel, such as "
                       f"0.05")
    origin = document.get("origin")
    numbers = [_number(item) for item in origin] if isinstance(origin, list) else []
    if len(numbers) != 3 or None in numbers:
        raise MapError(f"{path}: origin is {_shown(document, 'origin')}; expected [x, y, yaw] in metres and radians")
    negate = document.get("negate", "0")
    if negate not in ("0", "1"):
        raise MapError(f"{path}: negate is {_shown(document, 'negate')}; expected 0 or 1")
    image = document.get("image")
    if not isinstance(image, str) or not image:
        raise MapError(f"{path}: image is {_shown(document, 'image')}; expected the name of a .pgm or .png file")
    png, width, height, pixels = _image(os.path.join(os.path.dirname(os.path.abspath(path)), image))
    occupied = _number(document.get("occupied_thresh"))
    walls = _walls(pixels, negate == "1", OCCUPIED if occupied is None else occupied)
    x, y, yaw = numbers
    return Map(png, width, height, resolution, (x, y, yaw), negate == "1", walls)


def _read_file(path: str, limit: int) -> bytes:
    try:
        # Opening a pipe may block, and a device may be endless.
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise MapError(f"{path}: is a directory or a device. Correct map_file, or the image that it names")
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            data = b"" if size > limit else file.read(size)
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}. Correct map_file, or the image that it "
                       "names") from None
    except ValueError as error:  # an invalid character in the path
        raise error if isinstance(error, MapError) else MapError(
            f"{path!r}: is not a valid file name ({error})") from None
    if size > limit:
        raise MapError(f"{path}: is larger than {limit // 1024} kB: crop or scale the map")
    return data


def _walls(pixels: bytes, negate: bool, occupied: float) -> bytes:
    """Whether each pixel is occupied, as `map_server` decides it."""
    is_wall = bytes((value if negate else 255 - value) / 255.0 > occupied for value in range(256))
    return pixels.translate(is_wall)


def _image(path: str) -> Tuple[bytes, int, int, bytes]:
    """Return a PNG, its width and height, and its pixels; no pixels: not known."""
    data = _read_file(path, MAX_IMAGE_BYTES)
    try:
        if data.startswith(PNG_SIGNATURE):
            return (data, *png_size(data), b"")
        grey = read_pgm(data)
    except BadImage as error:
        raise MapError(f"{path}: cannot be shown: {error}. Expected a PGM or PNG image") from None
    return write_png(grey), grey.width, grey.height, grey.pixels


def _number(found: Any) -> Optional[float]:
    """Read a finite number of reasonable size; None for anything else."""
    try:
        value = float(found) if isinstance(found, str) else math.nan
    except ValueError:
        return None
    return value if abs(value) <= 1e9 else None


def _shown(document: Dict[Any, Any], key: str) -> str:
    """Format the value of a key for messages."""
    text = repr(document.get(key))
    return text if len(text) <= _LONGEST_SHOWN else text[:_LONGEST_SHOWN - 3] + "..."
