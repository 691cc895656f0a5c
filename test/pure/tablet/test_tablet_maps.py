"""Maps: positions of pixels, valid files, and errors of invalid files."""

import math
import pathlib
import struct
import zlib

import pytest

from roah_rsbb.tablet import maps
from roah_rsbb.tablet.maps import Map, MapError

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "resource" / "maps" / "dummy.yaml"
# Two pixels wide, three high; each another grey.
GREYS = bytes([0, 50, 100, 150, 200, 250])
PGM = b"P5\n# by hand\n2 3\n255\n" + GREYS


def a_map(width=200, height=100, resolution=0.05, origin=(0.0, 0.0, 0.0)):
    return Map(b"", width, height, resolution, origin, False)


def unpacked(png):
    """Size and pixels of a grey PNG, read by its specification; every chunk's checksum is right."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    at, chunks = 8, {}
    while at < len(png):
        (size,), kind = struct.unpack(">I", png[at:at + 4]), png[at + 4:at + 8]
        data = png[at + 8:at + 8 + size]
        assert struct.unpack(">I", png[at + 8 + size:at + 12 + size]) == (zlib.crc32(kind + data),)
        chunks[kind] = data
        at += 12 + size
    assert list(chunks) == [b"IHDR", b"IDAT", b"IEND"]
    width, height, *rest = struct.unpack(">IIBBBBB", chunks[b"IHDR"])
    assert rest == [8, 0, 0, 0, 0]
    rows = zlib.decompress(chunks[b"IDAT"])
    step = width + 1
    assert len(rows) == step * height and all(rows[row * step] == 0 for row in range(height))
    return width, height, b"".join(rows[row * step + 1:(row + 1) * step] for row in range(height))


@pytest.fixture
def saved(tmp_path):
    """Save a map's files; return the YAML file's path."""
    def save(yaml="image: it.pgm\nresolution: 0.5\norigin: [1, 2, 0]\n", image=PGM, name="it.pgm"):
        if image is not None:
            (tmp_path / name).write_bytes(image)
        path = tmp_path / "map.yaml"
        path.write_bytes(yaml if isinstance(yaml, bytes) else yaml.encode())
        return str(path)
    return save


# -- places ----------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("u", "v", "place"), [
    (0.0, 1.0, (-1.0, -2.0)),  # the lower left corner is the origin
    (1.0, 1.0, (9.0, -2.0)), (0.0, 0.0, (-1.0, 3.0)), (1.0, 0.0, (9.0, 3.0)), (0.25, 0.2, (1.5, 2.0)),
])
def test_the_origin_of_the_map_is_the_lower_left_corner_of_the_image(u, v, place):
    assert a_map(origin=(-1.0, -2.0, 0.0)).to_metres(u, v) == pytest.approx(place)


@pytest.mark.parametrize(("yaw", "right_corner"), [
    (math.pi / 2, (0.0, 10.0)), (-math.pi / 2, (0.0, -10.0)), (math.pi, (-10.0, 0.0)),
    (math.radians(30), (8.660254, 5.0)),
])
def test_yaw_turns_the_image_counter_clockwise_around_its_origin(yaw, right_corner):
    turned = a_map(origin=(3.0, 4.0, yaw))
    assert turned.to_metres(0.0, 1.0) == pytest.approx((3.0, 4.0))
    expected = (3.0 + right_corner[0], 4.0 + right_corner[1])
    assert turned.to_metres(1.0, 1.0) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (-3.5, 12.25, 0.7), (1.0, -1.0, -2.5)])
@pytest.mark.parametrize("point", [(0.0, 0.0), (1.0, 0.25), (0.3, 0.9)])
def test_a_place_is_found_again_in_the_image(origin, point):
    plan = a_map(width=317, height=90, resolution=0.033, origin=origin)
    assert plan.to_image(*plan.to_metres(*point)) == pytest.approx(point)


# -- images ----------------------------------------------------------------------------------------------

@pytest.mark.parametrize("pgm", [
    PGM,
    b"P5 2 3 255\n" + GREYS,
    b"P2\n2 # wide\n3 # high\n255\n0 50\n100 150\n200 250\n",
    b"P5\n2 3\n65535\n" + b"".join(struct.pack(">H", grey * 257) for grey in GREYS),
    b"P2 2 3 51 0 10 20 30 40 50",
])
def test_every_kind_of_pgm_is_the_same_image(pgm):
    assert unpacked(maps.write_png(maps.read_pgm(pgm))) == (2, 3, GREYS)


def test_an_image_keeps_its_rows():
    """The top row of the PGM is the top row of the PNG."""
    wide = maps.read_pgm(b"P5 3 1 255\n" + bytes([1, 2, 3]))
    assert unpacked(maps.write_png(wide)) == (3, 1, bytes([1, 2, 3]))


@pytest.mark.parametrize("pgm", [
    b"", b"P5", b"P6 1 1 255\n\0\0\0", b"P5 2 3 255\n" + GREYS[:-1], b"P5 0 3 255\n", b"P5 9000 1 255\n",
    b"P5 2 3 0\n" + GREYS, b"P5 2 3 65536\n" + GREYS, b"P5 -2 3 255\n" + GREYS, b"P5 2 x 255\n" + GREYS,
    b"P5 99999999999999999999 3 255\n", b"P2 2 3 255 0 1 2", b"P2 2 3 255 0 1 2 3 4 x", b"P2 2 3 255 0 1 2 3 4 -5",
    b"P5 # a comment without an end",
])
def test_a_broken_pgm_is_refused(pgm):
    with pytest.raises(maps.BadImage):
        maps.read_pgm(pgm)


# -- files -----------------------------------------------------------------------------------------------

def test_a_map_is_read_as_map_saver_writes_it(saved):
    plan = maps.load(saved())
    assert plan[1:] == (2, 3, 0.5, (1.0, 2.0, 0.0), False, bytes(grey < 90 for grey in GREYS))
    assert unpacked(plan.png) == (2, 3, GREYS)


def test_a_png_is_served_unchanged(saved):
    png = maps.write_png(maps.read_pgm(PGM))
    plan = maps.load(saved("image: it.png\nresolution: 0.5\norigin: [1, 2, 0]\nnegate: 1\n", png, "it.png"))
    assert plan == Map(png, 2, 3, 0.5, (1.0, 2.0, 0.0), True)
    other = maps.write_png(maps.read_pgm(PGM[:-1] + b"\0"))
    assert plan.version != plan._replace(png=other).version


def test_an_image_may_be_named_with_its_whole_path(saved, tmp_path):
    assert maps.load(saved(f"image: {tmp_path}/it.pgm\nresolution: 1\norigin: [0, 0, 0]\n")).width == 2


GOOD = {"image": "it.pgm", "resolution": "0.5", "origin": "[0, 0, 0]"}


@pytest.mark.parametrize(("changes", "reported"), [
    ({"image": None}, "image is None"), ({"image": "[3]"}, "image is"), ({"image": "missing.pgm"}, "cannot be read"),
    ({"image": "map.yaml"}, "not a PGM file"), ({"resolution": None}, "resolution is None"),
    ({"resolution": "0"}, "resolution is '0'"), ({"resolution": "-0.05"}, "resolution is '-0.05'"),
    ({"resolution": ".nan"}, "resolution is '.nan'"), ({"resolution": "true"}, "resolution is 'true'"),
    ({"resolution": "fine"}, "resolution is 'fine'"), ({"origin": None}, "origin is None"),
    ({"origin": "[0, 0]"}, r"origin is \['0', '0'\]"), ({"origin": "[0, 0, .inf]"}, "origin is"),
    ({"origin": "[0, 0, x]"}, "origin is"), ({"negate": "2"}, "negate is '2'"), ({"negate": "[]"}, "negate is"),
    ({"image": '"a\\0b"'}, "not a valid file name"), ({"image": '"\\ud800"'}, "not a valid file name"),
    ({"image": "/dev/zero"}, "a device"),
    ({"image": "."}, "a directory"), ({"resolution": "1" + "0" * 400}, "resolution is"),
])
def test_errors_in_a_map_file_are_named(saved, changes, reported):
    lines = [f"{key}: {value}\n" for key, value in {**GOOD, **changes}.items() if value is not None]
    with pytest.raises(MapError, match=reported):
        maps.load(saved("".join(lines)))


@pytest.mark.parametrize("yaml", ["", "[]", "a: [", "text", b"\xff\xfe\x00", "a: &a [*a]\n", "- " * 20000, "#" * 70000,
    # PyYAML stumbles over these.
    "a: 2015-99-99\n", "!!timestamp x", "!!int ''", "!!float x", "resolution: " + "9" * 5000, "%YAML 9" + "9" * 5000,
])
def test_an_invalid_map_file_is_refused(saved, yaml):
    with pytest.raises(MapError):
        maps.load(saved(yaml))


def test_a_missing_map_file_is_refused(tmp_path):
    with pytest.raises(MapError, match="map_file"):
        maps.load(str(tmp_path / "none.yaml"))


def test_the_shipped_map_is_the_flat():
    plan = maps.load(str(SHIPPED))
    width, height, pixels = unpacked(plan.png)
    assert (width, height) == (plan.width, plan.height)
    assert plan.to_metres(1.0, 0.0) == pytest.approx((10.0, 7.0))

    def grey(x, y):
        u, v = plan.to_image(x, y)
        return pixels[int(v * height) * width + int(u * width)]

    assert grey(5.05, 0.5) == 0, "a wall"
    assert grey(2.0, 3.0) == 254, "the floor"
    assert grey(0.8, 1.0) == 150, "furniture in the lower left room"


def test_walls_are_what_map_server_calls_occupied(saved):
    yaml = "image: it.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: {}\noccupied_thresh: {}\n"
    pgm = b"P5 4 1 255 " + bytes((0, 100, 205, 254))
    for negate, occupied, walls in ((0, 0.65, "1000"), (0, 0.5, "1100"), (1, 0.65, "0011"), (1, 0.9, "0001")):
        plan = maps.load(saved(yaml.format(negate, occupied), pgm, "it.pgm"))
        shown = "".join(str(int(plan.is_wall(u, 0.5))) for u in (0.0, 0.3, 0.6, 1.0))
        assert shown == walls, (negate, occupied)
    assert not any(plan._replace(walls=b"").is_wall(u, 0.0) for u in (0.0, 1.0)), "of a PNG they are not known"
