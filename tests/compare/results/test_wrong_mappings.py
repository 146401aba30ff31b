"""A mapping that is wrong in one thing: the result is not ok, and triage names that thing."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from compare.judge.causes.cause import Kind
from compare.judge.causes.words import words
from compare.judge.foreign import assess_result
from compare.judge.triage import cause
from compare.results.result import read_result
from scenes import Scene, Status
from scenes.channels import named
from scenes.model.motion import Samples
from tests import scene_files
from tests.comparisons import SLOW, References, sampled
from tests.foreign import Writer, channels, instants, write

Columns = dict[str, Samples]
Spoil = Callable[[Scene, Columns], Columns]
SCENE = "offset_slider_crank"
WRITER = Writer(decimals=".9g")


@dataclass(frozen=True)
class Wrong:
    """What a mapping has wrong, or leaves out, and what is to be named."""

    kind: Kind
    words: str
    writer: Writer = WRITER
    spoil: Spoil = lambda _, columns: columns


def written(**change: object) -> Writer:
    return replace(WRITER, **change)  # type: ignore[arg-type]


def opposite(*names: str) -> Spoil:
    return lambda _, columns: columns | {name: -columns[name] for name in names}


def exchanged(first: list[str], second: list[str]) -> Spoil:
    pairs = list(zip(first + second, second + first, strict=True))
    return lambda _, columns: columns | {a: columns[b] for a, b in pairs}


def by_angle(size: float) -> Spoil:
    """Return rates by the crank's angle, in units of `size` rad."""
    orders = {"vx": 1, "vy": 1, "omega": 1, "ax": 2, "ay": 2, "alpha": 2}

    def spoil(scene: Scene, columns: Columns) -> Columns:
        rate = float(scene.drive.law.at(0.0).rate)
        return {c: v * (size / rate) ** orders.get(named(c).name, 0) for c, v in columns.items()}

    return spoil


def late(by: float) -> Spoil:
    def spoil(scene: Scene, columns: Columns) -> Columns:
        names = [c for c in columns if c != "time"]
        return WRITER.columns(scene, columns["time"] - by * scene.cycle, names) | {"time": columns["time"]}

    return spoil


def backwards(scene: Scene, columns: Columns) -> Columns:
    """Return a crank that turns the other way from its start, at the same speed."""
    back = WRITER.columns(scene, -columns["time"], [c for c in columns if c != "time"])
    odd = {c: -v if named(c).name in ("vx", "vy", "omega") else v for c, v in back.items()}
    return odd | {"time": columns["time"]}


def elsewhere(_: Scene, columns: Columns) -> Columns:
    return columns | {"slider.guide_moment": columns["slider.guide_moment"] + 0.02 * columns["slider.guide_force"]}


def in_rpm(_: Scene, columns: Columns) -> Columns:
    return columns | {c: v * 30 / np.pi for c, v in columns.items() if named(c).name == "omega"}


def over_degrees(scene: Scene, columns: Columns) -> Columns:
    """Return rows by the crank's angle, in degrees."""
    angle = np.degrees(scene.drive.law.at(columns["time"]).position)
    return {"crank_angle": angle} | {c: v for c, v in columns.items() if c != "time"}


T, A = ([f"{point}.{q}" for q in ("x", "y", "vx", "vy", "ax", "ay")] for point in "TA")
MAPPINGS = {
    "millimetres": Wrong(Kind.unit, "all lengths are in mm", written(length=1e-3)),
    "inches": Wrong(Kind.unit, "all lengths are in in", written(length=0.0254)),
    "degrees": Wrong(Kind.unit, "deg in place of rad", written(angle=np.pi / 180)),
    "kilonewtons": Wrong(Kind.unit, "kN in place of N", written(force=1e3)),
    "mirrored": Wrong(Kind.frame, "in another frame, mirrored", written(mirrored=True)),
    "turned": Wrong(Kind.frame, "in another frame, turned by 34.38 deg", written(turn=0.6)),
    "shifted": Wrong(Kind.frame, "its origin at (120 mm, -340 mm)", written(origin=complex(0.12, -0.34))),
    "all of it": Wrong(
        *(Kind.frame, "mirrored, turned by 34.38 deg, with its origin at (120 mm, -340 mm) and all lengths are in mm"),
        written(mirrored=True, turn=0.6, origin=complex(0.12, -0.34), length=1e-3),
    ),
    "other sides": Wrong(
        Kind.sign, "all forces have the opposite sign, as on the other body", written(other_side=True)
    ),
    "other side": Wrong(Kind.sign, "B's force has the opposite sign, as on the", spoil=opposite("B.fx", "B.fy")),
    "sign of an axis": Wrong(Kind.sign, "A along y has the opposite sign", spoil=opposite("A.y", "A.vy", "A.ay")),
    "components": Wrong(Kind.swap, "A's position has its components swapped", spoil=exchanged(["A.x"], ["A.y"])),
    "points": Wrong(Kind.swap, "A and T are swapped", spoil=exchanged(T, A)),
    "late": Wrong(Kind.lag, "all but the drive is 8.5 ms late", spoil=late(0.017)),
    "far too late": Wrong(Kind.lag, "all but the drive is 150 ms early", spoil=late(0.7)),
    "backwards": Wrong(Kind.drive, "the drive runs at another speed, backwards", spoil=backwards),
    "rpm": Wrong(Kind.unit, "rpm in place of rad/s", spoil=in_rpm),
    "per degree": Wrong(Kind.unit, "all rates are by the crank's angle, per degree", spoil=by_angle(np.pi / 180)),
    "per radian": Wrong(Kind.unit, "all rates are by the crank's angle, per radian", spoil=by_angle(1.0)),
    "another point": Wrong(Kind.moment, "slider's guide moment is about another point, 20 mm", spoil=elsewhere),
    "axis in deg": Wrong(Kind.unit, "by which the rows are, is in deg in place of rad", spoil=over_degrees),
}
QUICK = ("millimetres", "mirrored", "turned", "far too late")


@sampled(2)
@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else SLOW) for name in MAPPINGS])
def test_it_is_named_as_what_it_is(name: str, tmp_path: Path, references: References) -> None:
    reference, wrong = references(SCENE), MAPPINGS[name]
    scene = scene_files.load(SCENE)
    columns = wrong.spoil(scene, wrong.writer.columns(scene, instants(scene, 60), channels(scene)))
    result = read_result(scene, f"theirs={write(tmp_path, WRITER.texts(columns), '')}")
    assert assess_result(reference, result).run.status is not Status.ok
    assert result.run.motion is not None
    found = cause(reference, result.request, result.run.motion)
    assert wrong.words in words(scene, found)
    assert found.kind is wrong.kind
