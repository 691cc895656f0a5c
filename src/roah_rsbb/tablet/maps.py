"""The map of a `map_server` YAML file: its image for browsers, and where its pixels are.

Pixels count from the image's top left corner, u to the right and v downwards, in fractions of the image (0 to
1) so that a page need not know at which size it shows it. Metres are those of the map: `origin` is the place of
the image's bottom left corner and the angle by which the image is turned counter-clockwise around it.
"""

import math
import os
import stat
import zlib
from typing import Any, Dict, NamedTuple, Optional, Tuple

import yaml

from roah_rsbb.tablet import images

# Files larger than this are no maps of a test bed.
MAX_YAML_BYTES = 64 * 1024
MAX_IMAGE_BYTES = 64 * 1024 * 1024
_LONGEST_SHOWN = 80


class MapError(ValueError):
    """A map that cannot be used; the text names the file, and what to do."""


class Map(NamedTuple):
    """A map, ready to be shown."""

    png: bytes
    width: int  # pixels
    height: int  # pixels
    resolution: float  # metres a pixel
    origin: Tuple[float, float, float]  # metres, metres, radians
    negate: bool  # the image is to be shown inverted

    @property
    def version(self) -> str:
        """Another one for another image: browsers keep images by their address."""
        return f"{zlib.crc32(self.png):08x}"

    def to_metres(self, u: float, v: float) -> Tuple[float, float]:
        """The place of a point of the image."""
        right = u * self.width * self.resolution
        up = (1.0 - v) * self.height * self.resolution
        x, y, yaw = self.origin
        return (x + right * math.cos(yaw) - up * math.sin(yaw), y + right * math.sin(yaw) + up * math.cos(yaw))

    def to_image(self, x: float, y: float) -> Tuple[float, float]:
        """The point of the image at a place; outside of it the fractions are outside 0 to 1."""
        origin_x, origin_y, yaw = self.origin
        east, north = x - origin_x, y - origin_y
        right = east * math.cos(yaw) + north * math.sin(yaw)
        up = north * math.cos(yaw) - east * math.sin(yaw)
        return right / (self.width * self.resolution), 1.0 - up / (self.height * self.resolution)


def load(path: str) -> Map:
    """The map of a YAML file as `map_server` reads it, with a PGM or PNG image. Raises `MapError`."""
    try:
        # Every value as the text that stands there: PyYAML stumbles over some that it takes for numbers or dates.
        document = yaml.load(_read(path, MAX_YAML_BYTES), Loader=yaml.BaseLoader)
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        if isinstance(error, MapError):
            raise
        raise MapError(f"{path}: this is no YAML: {' '.join(str(error).split())}") from None
    if not isinstance(document, dict):
        raise MapError(f"{path}: found no keys; expected image, resolution and origin, as map_saver writes them")
    resolution = _number(document.get("resolution"))
    if resolution is None or not 1e-4 <= resolution <= 10.0:
        raise MapError(f"{path}: resolution is {_shown(document, 'resolution')}; expected metres a pixel, such as 0.05")
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
    png, width, height = _image(os.path.join(os.path.dirname(os.path.abspath(path)), image))
    x, y, yaw = numbers
    return Map(png, width, height, resolution, (x, y, yaw), negate == "1")


def _read(path: str, limit: int) -> bytes:
    try:
        # A pipe might block for ever, and a device has no end.
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise MapError(f"{path}: is a directory or a device. Correct map_file, or image in it")
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            data = b"" if size > limit else file.read(size)
    except OSError as error:
        raise MapError(f"{path}: cannot be read: {error.strerror}. Correct map_file, or image in it") from None
    except ValueError as error:  # a NUL or half a character in the path
        raise error if isinstance(error, MapError) else MapError(f"{path!r}: is no file's name ({error})") from None
    if size > limit:
        raise MapError(f"{path}: is larger than {limit // 1024} kB: crop or scale the map")
    return data


def _image(path: str) -> Tuple[bytes, int, int]:
    data = _read(path, MAX_IMAGE_BYTES)
    try:
        if data.startswith(images.PNG_SIGNATURE):
            return (data, *images.png_size(data))
        grey = images.read_pgm(data)
    except images.BadImage as error:
        raise MapError(f"{path}: cannot be shown: {error}. Expected a PGM or PNG image") from None
    return images.write_png(grey), grey.width, grey.height


def _number(found: Any) -> Optional[float]:
    """What can be computed with: finite, and not so large that it becomes infinite; None: it is no such number."""
    try:
        value = float(found) if isinstance(found, str) else math.nan
    except ValueError:
        return None
    return value if abs(value) <= 1e9 else None


def _shown(document: Dict[Any, Any], key: str) -> str:
    """What stands at a key, for messages."""
    text = repr(document.get(key))
    return text if len(text) <= _LONGEST_SHOWN else text[:_LONGEST_SHOWN - 3] + "..."
