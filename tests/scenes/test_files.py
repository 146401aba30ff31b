"""Files that are no scenes: whatever is at the path, one line names the file and what is wrong, at once."""

import os
import socket
from collections.abc import Callable
from math import pi
from pathlib import Path
from time import process_time

import pint
import pytest

import scenes
from scenes.file import units
from scenes.limits import FILE_BYTES
from tests import scene_files
from tests.comparisons import sampled

TOGGLE_PRESS = scene_files.text("toggle_press")
AT_ONCE = 2.0  # s of the processor; the slowest here takes 0.2 s


def weighing(mass: str) -> bytes:
    """The file of a scene with another mass in it."""
    return TOGGLE_PRESS.replace("mass = 40", f"mass = {mass}").encode()


def short(value: object) -> str:
    """The id of a parameter, which may be of a megabyte."""
    return ascii(value)[:30]


def refused(name: str | Path, path: object = None) -> str:
    """Load what is no scene, and return what the line has after the file, or after another name of it."""
    started, start = process_time(), f"{name if path is None else path}: "
    line = scene_files.refused(lambda: scenes.load(name), len(start) + 549)  # with the names of all that ship
    assert process_time() - started < AT_ONCE
    assert line.startswith(start)
    return line.removeprefix(start)


def socket_at(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(path.name)


@pytest.mark.parametrize(
    ("make", "what"),
    [
        *((os.mkfifo, "a pipe"), (os.mkdir, "a folder"), (socket_at, "a socket")),
        (lambda path: path.symlink_to("/dev/zero"), "a device"),
        (lambda path: path.symlink_to("/dev/null"), "a device"),
        (lambda path: path.symlink_to(path), "Too many levels of symbolic links"),
        (lambda path: path.symlink_to("nothing"), "no such scene or file"),
    ],
)
def test_what_is_no_file(
    make: Callable[[Path], None], what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # a socket's path has to be short
    make(tmp_path / "a.toml")
    assert what in refused(tmp_path / "a.toml")


def test_a_file_that_must_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    file = scene_files.write(tmp_path, "toggle_press")
    monkeypatch.setattr(Path, "open", forbidden)  # the tests may run as root, who may read everything
    assert refused(file) == "cannot be read (Permission denied)"


@pytest.mark.parametrize(
    ("name", "shown", "why"),
    [
        ("x" * 300 + ".toml", "x" * 299 + "…", "File name too long"),
        ("x" * 300, "x" * 300, "File name too long"),
        ("a/" * 5000, "a/" * 149 + "a…", "File name too long"),
        ("a\0b.toml", r"a\x00b.toml", "null "),  # Python 3.13 has a character there, before it was a byte
        ("two\nlines.toml", "two lines.toml", "no such scene or file"),
        ("\x1b[31mred", r"\x1b[31mred", "no such scene or file"),
        ("half\udc80", r"half\udc80", "no such scene or file"),
        ("", "''", "found a folder"),
        ("no/such/file.toml", None, "no such scene or file"),
        ("pyproject.toml/a.toml", None, "Not a directory"),
    ],
    ids=short,
)
def test_odd_names(name: str, shown: str | None, why: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(Path(__file__).parents[2])
    assert why in refused(name, shown)


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"\xff\xfea\0", "expected a text file in UTF-8, and byte 0 is none"),
        (TOGGLE_PRESS.replace("Six", "S\u00efx").encode("latin-1"), "expected a text file in UTF-8"),
        (TOGGLE_PRESS.encode("utf-16"), "expected a text file in UTF-8"),
        (b"", "format: missing; the version of this format"),
        (b"\0" * 100, "not valid TOML"),
        (TOGGLE_PRESS.encode() + b"#" * FILE_BYTES, "expected a file of 1000000 bytes at most"),
        (b"a = " + b"9" * 5000, "4300 digits"),
        (b"a = [{ b = 0x" + b"f" * 200_000 + b" }]", "a.0.b: expected an integer of 64 bits at most"),
        (b"a = " + b"[" * 100_000, "not valid TOML"),
        (b"a = " + b"[" * 40 + b"]" * 40, "expected 32 levels of tables and lists at most"),
        (b"a." * 400_000 + b"a = 1", "expected keys of 20 parts at most"),
        (b"[" + b"a." * 100_000 + b"a]\n" + b"a1 = 1\n" * 100_000, "expected keys of 20 parts at most"),
        (b"[" + b'\'=\' \t. "\\"=" . ' * 10_000 + b"a]\n", "expected keys of 20 parts at most"),
        (b"x" * 100_000 + b" = 1\n" + TOGGLE_PRESS.encode(), "x…: unknown key"),
        (weighing("1979-05-27"), "bodies.rocker.mass: expected a number in kg"),
        (weighing("9" * 20), "bodies.rocker.mass: expected an integer of"),
        (weighing("1e999"), "bodies.rocker.mass: expected a finite number"),
        (weighing(f'"{"x" * 10_000}"'), "x…'"),
        (TOGGLE_PRESS.replace('"crank"', '"a\\u001b[2J"').encode(), "drive.body: no body 'a\\x1b[2J'"),
        (TOGGLE_PRESS.replace("format = 1", "format = 1979-05-27T07:32:00Z").encode(), "format: expected 1, found"),
        (TOGGLE_PRESS.replace("along = [0, 1]", "along = [0, 1e-320]").encode(), "slides.along: expected a direction"),
        (TOGGLE_PRESS.replace("along = [0, 1]", "along = [0, 1e308]").encode(), "slides.along: expected a direction"),
    ],
    ids=short,
)
def test_odd_contents(content: bytes, why: str, tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_bytes(content)
    assert why in refused(file)


def test_a_mark_of_utf_8_before_the_text(tmp_path: Path, toggle_press: scenes.Scene) -> None:
    file = tmp_path / "a.toml"
    file.write_text(TOGGLE_PRESS.replace("\n", "\r\n"), encoding="utf-8-sig")
    assert scenes.load(file).bodies == toggle_press.bodies


def test_a_title_is_one_line(tmp_path: Path) -> None:
    file = tmp_path / "a.toml"
    file.write_text(TOGGLE_PRESS.replace('title = "', 'title = "two\\n\\u001blines '), encoding="utf-8")
    assert scenes.load(file).title.startswith(r"two \x1blines ")


NO_UNITS = [
    *(["9**9**9**9*m", "m!", "m;", "m**1e9", "m**999999999", "m**m", "2*m", "__import__('os')", "m**-", "-m"]),
    *("(" * 1000 + "m" + ")" * 1000, "m*" * 20_000 + "m", "*".join(f"m{i}" for i in range(20_000)), "x" * 100_000),
    *(["Qm**9/Qm**8/Qm**2/Qm**2", "qm**9/m**8", "lambda", "dBm/degC", "nan", "None", "м", "m/**2", "kg", "m**.5"]),
    *("m\n", "m m", "m\x1b"),
]


@sampled(9)
@pytest.mark.parametrize("unit", NO_UNITS, ids=short)
def test_no_units_of_length(unit: str) -> None:
    line = scene_files.refused(lambda: scenes.load("toggle_press", {"units.length": unit}), 699)
    assert ": units.length: '" in line
    assert "product of powers of unit names, such as kg*m**2" in line or "is not a known unit of length" in line


@pytest.mark.parametrize(
    ("unit", "metres"),
    [
        *(("mm", 1e-3), ("µm", 1e-6), ("millimeter", 1e-3), ("inch", 0.0254), ("ft", 0.3048), ("m**2/m", 1.0)),
        *(("mm^2 / mm", 1e-3), ("mm**2 * mm**-1", 1e-3), ("km**0.5*m**0.5", 1000**0.5), ("", 1.0)),
    ],
)
def test_units_of_length(unit: str, metres: float) -> None:
    scene = scenes.load("toggle_press", {"units.length": unit, "units.angle": "°", "drive.start": 90})
    assert scene.ground["P1"][0] == pytest.approx(404.709 * metres, rel=1e-15)
    assert scene.drive.law.start == pytest.approx(pi / 2, rel=1e-15)


def test_the_usual_units_are_what_pint_takes_them_for() -> None:
    registry: pint.UnitRegistry[float] = pint.UnitRegistry()
    for (unit, si), factor in units._FACTORS.items():
        assert factor == pytest.approx(registry.Quantity(1.0, unit).to(si).magnitude, rel=1e-15)  # of an ulp of pint's
