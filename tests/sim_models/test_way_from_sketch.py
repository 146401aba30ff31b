"""The way from the sketch to the start lies inside the drive's range: past its ends the linkage may lock."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import compare
import scenes
from compare.engines import registry
from scenes import Sampling, Scene
from tests import scene_files
from tests.comparisons import sampled

from .formulations import run

SAMPLING = Sampling(24)
ENGINES = ("analytic", "exudyn", "pymunk", "multiprecision", "casadi", "pinocchio", "mujoco")


@dataclass(frozen=True)
class FourBar:
    """A four-bar that locks past the ends of its crank's range: ground 1 m, sketched exactly at an angle, deg."""

    crank: float  # m
    coupler: float
    rocker: float
    side: int  # of A-C, on which B is
    sketched: float
    drive: scene_files.Changes

    def end_of_coupler(self, angle: Any) -> Any:
        """Return B by the law of cosines, complex, m."""
        A = self.crank * np.exp(1j * np.asarray(angle))
        way = 1 - A
        along = (self.coupler**2 - self.rocker**2 + np.abs(way) ** 2) / (2 * np.abs(way))
        return A + way / np.abs(way) * (along + 1j * self.side * np.sqrt(self.coupler**2 - along**2))

    def scene(self, folder: Path) -> Scene:
        angle = np.radians(self.sketched)
        A, B = self.crank * np.exp(1j * angle), self.end_of_coupler(angle)
        tables = {
            "format": 1,
            "name": "range",
            "units": {"angle": "deg", "speed": "rpm"},
            "ground": {"points": {"O": [0, 0], "C": [1, 0]}},
            "bodies": {
                "crank": {"lengths": {"O-A": self.crank}},
                "coupler": {"lengths": {"A-B": self.coupler}},
                "rocker": {"lengths": {"C-B": self.rocker}},
            },
            "drive": {"body": "crank", **self.drive},
            "sketch": {"angle": self.sketched, **{n: [float(z.real), float(z.imag)] for n, z in (("A", A), ("B", B))}},
            "output": {"point": "B"},
        }
        file = folder / "range.toml"
        file.write_text(scene_files.toml(tables), encoding="utf-8")
        return scenes.load(file)


def once(start: float, end: float) -> scene_files.Changes:
    return {"speed": 10 if end > start else -10, "start": start, "end": end}


TO_AND_FRO = {"law": [[0, -120], [0.5, 0], [1, 120], [1.5, 0], [2, -120]], "periodic": True}
ONCE_BY_A_LAW = {"law": [[0, -110], [0.3, -88], [0.7, 88], [1, 110]], "periodic": False}
WIDE = 0.5, 0.71, 0.73, 1  # from -145.4 to 145.4 deg
BEHIND = 0.8, 1.1, 0.72, -1  # from 20.8 to 339.2 deg
HAIR = 0.5, 0.74, 0.7595, 1  # from -177 to 177 deg
LINKAGES = {
    "over more than half a turn": FourBar(*WIDE, 100, once(-140, 140)),
    "backwards": FourBar(*WIDE, -100, once(140, -140)),
    "past the end": FourBar(*WIDE, 144, once(-140, 140)),
    "before the start": FourBar(*WIDE, -144, once(-140, 140)),
    "past the end backwards": FourBar(*WIDE, -144, once(140, -140)),
    "a turn further": FourBar(*WIDE, 460, once(-140, 140)),
    "two turns back": FourBar(*WIDE, 100, once(-860, -580)),
    "round the other side": FourBar(*BEHIND, 300, once(30, 330)),
    "round the other side, past the end": FourBar(*BEHIND, 335, once(30, 330)),
    "nearly all round": FourBar(*HAIR, 170, once(-172.5, 172.5)),
    "to and fro for ever": FourBar(*WIDE, 100, TO_AND_FRO),
    "to and fro for ever, past the end": FourBar(*WIDE, 140, TO_AND_FRO),
    "once by a law": FourBar(*WIDE, 100, ONCE_BY_A_LAW),
}


@sampled(8)
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", LINKAGES)
def test_no_way_from_the_sketch_leads_through_a_lock(name: str, engine: str, tmp_path: Path) -> None:
    if not registry.ENTRIES[engine].missing:
        linkage, model = LINKAGES[name], registry.engine(engine)
        motion = run(model, linkage.scene(tmp_path), request=SAMPLING)
        off = motion["B.x"] + 1j * motion["B.y"] - linkage.end_of_coupler(motion["crank_angle"])
        assert np.abs(off).max() <= model.DEFAULT.promise  # of a stroke of about 1 m


@sampled(4)
@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("sketched", [0.076, 0.12, 0.164])
def test_a_driven_slider_goes_to_its_start_from_anywhere_in_its_range(sketched: float, engine: str) -> None:
    """A crank of 50 mm, a rod of 120 mm: between 70 and 170 mm the crank's pin is where two circles meet."""
    if registry.ENTRIES[engine].missing:
        return

    def pin(x: Any) -> Any:
        along = (0.05**2 - 0.12**2 + x**2) / (2 * x)
        return along + 1j * np.sqrt(0.05**2 - along**2)

    A = pin(sketched)
    changes = {
        "units": {},
        "bodies.crank": {"lengths": {"O-A": 0.05}},
        "bodies.rod": {"lengths": {"A-B": 0.12}},
        "bodies.slider": {"points": {"B": [0, 0]}, "slides": {"through": [0, 0], "along": [1, 0]}},
        "drive": {"body": "slider", "speed": -0.1, "start": 0.165, "end": 0.075},
        "sketch": {"displacement": sketched, "A": [A.real, A.imag], "B": [sketched, 0]},
        "output": {"point": "A"},
        "loads": None,
    }
    model = registry.engine(engine)
    motion = run(model, scene_files.load("slider_crank", changes), request=SAMPLING)
    off = motion["A.x"] + 1j * motion["A.y"] - pin(motion["drive.displacement"])
    assert np.abs(off).max() <= 0.1 * model.DEFAULT.promise  # of a stroke of about 0.1 m


def test_the_closed_form_is_believed_across_its_whole_range(tmp_path: Path) -> None:
    pytest.importorskip("flint")
    judged = compare.check(LINKAGES["over more than half a turn"].scene(tmp_path), engines=("analytic",), samples=24)
    assert judged.ok, judged.verdicts


@sampled(2)
@pytest.mark.parametrize("engine", ["exudyn", "pymunk", "multiprecision"])
@pytest.mark.parametrize("beside", [-5e-10, 0, 5e-10])
@pytest.mark.parametrize("between", [("crank", "rod"), ("rod", "crank")])
def test_half_a_turn_at_the_start_is_counter_clockwise(engine: str, beside: float, between: tuple[str, str]) -> None:
    """Whichever side of it rounding leaves, of a crank against its rod, and of the rod against it."""
    model = registry.engine(engine)
    massive = {"bodies.crank.mass": 1, "bodies.rod.mass": 1, "drive.start": np.pi + beside}
    spring = {"at": "A", "between": between, "stiffness": 500.0, "angle": 0.7}
    wound, bare = (
        run(model, scene_files.load("slider_crank", massive | springs), request=SAMPLING)
        for springs in ({"torsion_springs": [spring]}, {})
    )
    rate = bare[f"{between[1]}.omega"][0] - bare[f"{between[0]}.omega"][0]
    torque = wound["drive.torque"][0] - bare["drive.torque"][0]
    assert torque * 10 == pytest.approx(500 * (np.pi - 0.7) * rate, rel=1e-3)  # their promises
