"""Files that no vineyard gave: clouds, rig files, sites, configurations, references, rates, logs, trajectories."""
import struct

from lab import CRS

HEADER = ("ply\nformat binary_little_endian 1.0\ncomment crs {crs}\nelement vertex {count}\nproperty double x\n"
          "property double y\nproperty double z\nproperty double time\nproperty float nx\nproperty float ny\n"
          "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
          "end_header\n")
DEEP = "[" * 20000 + "]" * 20000


def cloud(rays, crs=CRS, count=None):
    """Bytes of a ray cloud; rays: (x, y, z, time, nx, ny, nz)."""
    body = b"".join(struct.pack("<4d3f4B", *ray, 90, 90, 90, 255) for ray in rays)
    return HEADER.format(crs=crs, count=len(rays) if count is None else count).encode() + body


def line_of_rays(x=455000.0, y=5238000.0, z=0.0, start=1614600000.0, n=2000, end=(1.0, 1.0, -1.0)):
    return [(x + 0.001 * i, y, z, start + 0.001 * i, *end) for i in range(n)]


def clouds(good):
    """{name: bytes}"""
    bad, header = float("nan"), good[:good.index(b"end_header") + 11]

    def changed(old, new, data=good):
        assert old in data
        return data.replace(old, new, 1)

    return {
        "empty file": b"", "no cloud": b"<html>\n" * 200, "only a header": header, "cut header": good[:60],
        "cut in a ray": good[:len(good) // 2 + 3], "too many rays claimed": cloud(line_of_rays(), count=10**15),
        "negative count": cloud(line_of_rays(), count=-5), "no rays": cloud([]),
        "count of 2^64": cloud([], count=2**64),
        "count of letters": cloud([], count="many"), "count of a fraction": cloud([], count="2.5"),
        "not numbers": cloud(line_of_rays(x=bad)), "infinite": cloud(line_of_rays(x=float("inf"))),
        "far away": cloud(line_of_rays(x=1e300)), "at the pole of nowhere": cloud(line_of_rays(x=0.0, y=0.0)),
        "deep below": cloud(line_of_rays(z=-1e9)), "degrees": cloud(line_of_rays(x=8.4, y=47.3)),
        "times of 1e300": cloud(line_of_rays(start=1e300)), "times not numbers": cloud(line_of_rays(start=bad)),
        "times before 1970": cloud(line_of_rays(start=-1e12)),
        "ends not numbers": cloud(line_of_rays(end=(bad, 0, 0))), "ends of 1e38": cloud(line_of_rays(end=(1e38, 0, 0))),
        "1000 km away": cloud(line_of_rays(x=455000 + 1e6)),
        "other crs": cloud(line_of_rays(), crs="EPSG:7854"),
        "crs nobody knows": cloud(line_of_rays(), crs="EPSG:999999"),
        "crs of control characters": cloud(line_of_rays(), crs="\x01\x02"),
        "local crs": cloud(line_of_rays(), crs="local"),
        "crs of a kilobyte": cloud(line_of_rays(), crs="E" * 1024),
        "geographic crs": cloud(line_of_rays(), crs="EPSG:4326"),
        "comment of a megabyte": b"ply\n" + b"comment " + b"a" * 10**6,
        "ascii": changed(b"binary_little_endian", b"ascii", header),
        "big endian": changed(b"binary_little_endian", b"binary_big_endian"),
        "version 9": changed(b" 1.0\n", b" 9.0\n"),
        "no x": changed(b"property double x\n", b""),
        "x twice": changed(b"property double y\n", b"property double x\n"),
        "x of bytes": changed(b"property double x\n", b"property uchar x\n"),
        "x of a type that is none": changed(b"property double x\n", b"property quad x\n"),
        "a list": changed(b"property double x\n", b"property list uchar int x\n"),
        "no time": changed(b"property double time\n", b""),
        "no vertices": changed(b"element vertex", b"element face", header),
        "vertices twice": changed(b"end_header\n", b"element vertex 5\nproperty double x\nend_header\n", header),
        "lines with carriage returns": header.replace(b"\n", b"\r\n"),
        "zero in the header": changed(b"ply\n", b"ply\n\0\n"),
        "a million properties": b"ply\n" + b"property double x\n" * 10**5, "header without end": header[:-11] * 500,
        "UTF-16": good[:300].decode("latin1").encode("utf-16"), "gzip": b"\x1f\x8b\x08\x00" + bytes(1000),
    }


def las(points=200, time=309132818.0, version=4, point_format=6, encoding=1, count=None, scale=0.001,
        offset=(455000.0, 5238000.0, 0.0), records=b"", record_count=0, point_bytes=30, begin=None):
    """Bytes of a LAS cloud: points under a vehicle that drives east at 1 m/s from 2021-07-01."""
    header_bytes = 375 if version == 4 else 227
    body = b"".join(struct.pack("<3iH2BBBhHd", 100 * i, 1000, 0, 90, 0x11, 0, 2, 0, 0, 0, time + 0.1 * i)
                    for i in range(points))
    header = b"LASF" + struct.pack(
        "<HH16x2B64xHHHIIBHI20x", 0, encoding, 1, version, 182, 2021, header_bytes,
        header_bytes + len(records) if begin is None else begin, record_count, point_format, point_bytes, 0)
    header += struct.pack("<6d48x", scale, scale, scale, *offset)
    if version == 4:
        header += struct.pack("<QQIQ", 0, 0, 0, points if count is None else count)
    return header.ljust(header_bytes, b"\0") + records + body


def las_record(record, payload, length=None):
    size = len(payload) if length is None else length
    return struct.pack("<H16sHH32x", 0, b"LASF_Projection", record, size) + payload


def las_keys(*keys):
    numbers = [1, 1, 0, len(keys)]
    for key, value in keys:
        numbers += [key, 0, 1, value]
    return las_record(34735, struct.pack(f"<{len(numbers)}H", *numbers))


def las_path(start=1625097600.0, n=210):
    return "".join(f"{start + 0.1 * i} {455000 + 0.1 * i} 5238000 2 0 0 0 1\n" for i in range(n))


def las_clouds():
    """{name: bytes}"""
    good, bad = las(), float("nan")

    def with_record(record, **more):
        return las(records=record, record_count=1, **more)

    return {
        "no LAS": b"LASF", "LAS cut in the header": good[:200], "LAS cut in a point": good[:-7],
        "LAS of text": b"LASF" * 500, "LAS 1.1": las(version=1), "LAS 1.9": las(version=9),
        "LAZ": las(point_format=0x86), "LAS without times": las(point_format=0),
        "LAS of a format that is none": las(point_format=99), "LAS of no points": las(points=0),
        "LAS of 2^64 points": las(count=2**64 - 1), "LAS of too few points": las(count=5),
        "LAS points of no bytes": las(point_bytes=0), "LAS points too short": las(point_bytes=20),
        "LAS points of 64 kB": las(point_bytes=65535), "LAS scale of 0": las(scale=0.0),
        "LAS scale of nan": las(scale=bad), "LAS scale of 1e300": las(scale=1e300),
        "LAS offset of nan": las(offset=(bad, 0, 0)), "LAS offset of 1e300": las(offset=(1e300, 0, 0)),
        "LAS far from its trajectory": las(offset=(0.0, 0.0, 0.0)),
        "LAS times of another day": las(time=309132818.0 - 86400), "LAS times not numbers": las(time=bad),
        "LAS times of 1e300": las(time=1e300), "LAS points in the header": las(begin=100),
        "LAS points behind the end": las(begin=2**32 - 1), "LAS of 2^32 records": las(record_count=2**32 - 1),
        "LAS record too long": with_record(las_record(2112, b"x", 65535)),
        "LAS crs of deep WKT": with_record(las_record(2112, b'PROJCS["x",' + b"A[" * 20000), encoding=17),
        "LAS crs that is none": with_record(las_record(2112, b"/etc/passwd"), encoding=17),
        "LAS of another crs": with_record(las_keys((3072, 7854))),
        "LAS of a geographic crs": with_record(las_keys((1024, 2), (2048, 4326))),
    }


LAS_PATHS = {
    "none": None, "empty": "", "of another day": las_path(start=1.5e9),
    "of one pose": "1625097605 455000 5238000 2 0 0 0 1\n",
    "of a table without heights": "time,x,y\n1625097600,455000,5238000\n",
    "of a table in degrees": "time,lat,lon,height\n1,2,3,4\n", "of a table of words": "time,x,y,z\na,b,c,d\n",
    "of a table of nan": "time,x,y,z\n1625097600,nan,nan,nan\n", "of columns without end": "time" + ",x" * 1000 + "\n",
    "of a table cut in a line": "time,x,y,z\n1625097600,455000,52", "in another crs": "# crs: EPSG:7854\n" + las_path(),
    "in a crs that is none": "# crs: x\n" + las_path()}


def tomls(good, kind):
    """{name: text} of TOML files that go wrong in ways that do not depend on what they are for."""
    first = next(line for line in good.splitlines() if line.startswith("["))
    return {
        f"empty {kind}": "", f"{kind} that is no TOML": "[[[", f"{kind} of control characters": good + "\x01 = 1\n",
        f"{kind} with a zero": good + "a = \"\x00\"\n", f"{kind} with an unknown table": good + "\n[nonsense]\na = 1\n",
        f"{kind} with an unknown key": good.replace(first, first + "\nnonsense = 1", 1),
        f"{kind} of arrays in arrays": "a = " + DEEP, f"{kind} of tables in tables": "a" + ".a" * 50000 + " = 1",
        f"{kind} that says a table twice": good + "\n" + first + "\n" + first + "\n",
        f"{kind} cut short": good[:len(good) // 2],
        f"{kind} that is a string of a megabyte": "a = \"" + "x" * 10**6 + "\"",
        f"{kind} of a large number": "a = 1" + "0" * 400,
        f"{kind} in UTF-16": good.encode("utf-16"), f"{kind} that is no UTF-8": b"a = \"\xff\xfe\"",
    }


def changed_values(good, values):
    """{name: text}: lines of a TOML file with another value; values: (key, value)."""
    lines = good.splitlines()
    found = {}
    for key, value in values:
        at = next(i for i, line in enumerate(lines) if line.split("=")[0].strip() == key)
        found[f"{key} = {value[:60]}"] = "\n".join([*lines[:at], f"{key} = {value}", *lines[at + 1:]]) + "\n"
    return found


RIG_VALUES = (
    ("topic", "5"), ("topic", '""'), ("min_range_m", "-1"), ("min_range_m", "nan"), ("max_range_m", "inf"),
    ("max_range_m", "1e300"), ("max_range_m", "0"), ("no_return", '"never"'), ("axis", "[0, 0, 0]"),
    ("axis", "[nan, 0, 1]"),
    ("axis", "[0, 0]"), ("gyro_noise_rad_s_sqrt_hz", "0"), ("gyro_noise_rad_s_sqrt_hz", "-1"),
    ("accel_noise_m_s2_sqrt_hz", '"much"'), ("lidar_offset_s", "1e30"), ("estimate_gps_offset", "2"),
    ("imu_from_spinner", "{ xyz = [0, 0, 0], q = [0, 0, 0, 0] }"), ("imu_from_spinner", "{ xyz = [1e9, 0, 0] }"),
    ("spinner_from_lidar", "{ xyz = [0, 0], q = [1, 0, 0, 0] }"), ("imu_from_gps", "[]"), ("joint", "[]"))
SITE_VALUES = (
    ("count", "-1"), ("count", "0"), ("count", "1000000000"), ("count", "2.5"), ("length_m", "0"), ("length_m", "1e9"),
    ("length_m", "nan"), ("spacing_m", "0"), ("spacing_m", "-3"), ("spacing_m", "inf"), ("azimuth_deg", "1e300"),
    ("panel_length_m", "0"), ("panel_length_m", "1e-9"), ("leaf_area_m2_per_m", "1e12"), ("leaf_area_m2_per_m", "-1"),
    ("slope_percent", "1e9"), ("latitude_deg", "91"), ("latitude_deg", "nan"), ("longitude_deg", "1e5"),
    ("trees", "1000000000"), ("buildings", "-2"), ("beams", "0"), ("beams", "100000000"), ("fence", '"yes"'),
    ("date", '"2021-02-30"'), ("date", '"../../x"'), ("leaf_fraction", "7"), ("seed", "-1"))


def references(good):
    """{name with ending: text or bytes}"""
    def point(x, y):
        return ('{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Point",'
                f'"coordinates":[{x},{y}]}}}}]}}')
    return {
        "empty.geojson": "", "empty.csv": "", "empty.gpkg": b"", "cut.geojson": good[:len(good) // 2],
        "text.gpkg": "text" * 999,
        "header.gpkg": b"SQLite format 3\0" + bytes(4000), "arrays.geojson": DEEP, "none.geojson":
        '{"type":"FeatureCollection","features":[]}', "null.geojson": "null", "number.geojson": "5",
        "pole.geojson": point(0, 90), "nowhere.geojson": point(1e300, 1e300), "metres.geojson": point(455000, 5238000),
        "letters.geojson": point('"a"', '"b"'), "apart.geojson": point(8.4, 47.3).replace(
            "]}", ']},"more":{"type":"Point","coordinates":[9.9,47.3]', 1),
        "polygon.geojson": '{"type":"Polygon","coordinates":[[[8.4,47.3],[8.5,47.3],[8.4,47.4],[8.4,47.3]]]}',
        "columns.csv": "a,b\n1,2\n", "place.csv": "x,y\n1,2\n", "words.csv": "easting,northing\nfar,away\n",
        "nan.csv": "easting,northing\nnan,nan\n", "inf.csv": "longitude,latitude\ninf,47\n", "far.csv":
        "easting,northing\n455000,5238000\n555000,5238000\n", "quote.csv": 'easting,northing\n"455000,5238000\n',
        "zero.csv": b"easting,northing\n455000,\x005238000\n", "wide.csv": "easting" + ",a" * 100000 + "\n",
        "unknown.ending": good, "none": good, "csv.geojson": "easting,northing\n455000,5238000\n"}


RATES = {
    "empty": "", "without columns": "1,2\n", "of words": "zone,rate\none,two\n",
    "of a zone that is none": "zone,rate\n99,1\n",
    "negative": "zone,rate\n1,-5\n2,1\n3,1\n", "not numbers": "zone,rate\n1,nan\n2,1\n3,1\n", "infinite":
    "zone,rate\n1,inf\n2,1\n3,1\n", "of one zone twice": "zone,rate\n1,5\n1,6\n2,1\n3,1\n", "of zones that are missing":
    "zone,rate\n1,5\n", "too large": "zone,rate\n1,1e300\n2,1\n3,1\n",
    "with a quote": 'zone,rate\n"1,5\n', "with a zero":
    "zone,rate\n1,\x005\n", "of a line of a megabyte": "zone,rate\n" + "1" * 10**6}


def logs(good):
    """{name: bytes} of bags."""
    record = struct.pack("<I", 2**32 - 1)
    return {
        "empty": b"", "magic only": good[:13], "version 1.2": good.replace(b"V2.0", b"V1.2", 1),
        "text": b"bag\n" * 1000,
        "cut in the header": good[:60], "cut in a chunk": good[:len(good) // 3],
        "huge header": good[:13] + record + bytes(999),
        "huge data": good[:13] + struct.pack("<I", 4) + bytes(4) + record, "zeros": good[:13] + bytes(100000),
        "tiny records": good[:13] + struct.pack("<II", 0, 0) * 300000, "noise": good[:4096] + bytes(range(256)) * 400}


def trajectories(good):
    """{name: text or bytes} of trajectories."""
    lines = [line for line in good.splitlines() if not line.startswith("#")]
    return {
        "empty": "", "words": "a b c d e f g h\n", "too few numbers": "1 2 3\n" * 99, "not numbers": "nan " * 8 + "\n",
        "one pose": lines[0] + "\n", "times that go back": "\n".join(lines[::-1]), "quaternions of nothing":
        "\n".join(" ".join(line.split()[:4] + ["0"] * 4) for line in lines), "of another day":
        "\n".join(f"{i} 0 0 0 0 0 0 1" for i in range(99)), "places of 1e300":
        "\n".join(" ".join([line.split()[0], "1e300", "0", "0", "0", "0", "0", "1"]) for line in lines),
        "bzip2 that is none": b"BZh9" + bytes(500), "one line of a megabyte": "1" * 10**6}
