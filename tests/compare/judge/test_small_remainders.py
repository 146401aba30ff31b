"""What is left of large terms is no fault of the core: drives with nothing to do, small strokes, level springs.

Every scene here has a core that is right to what its numbers' last places leave, by its derivation in the comment.
"""

from dataclasses import replace
from math import cos, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

from compare import check
from compare.engines.runner import Run
from compare.judge.checks import checks, estimate
from compare.judge.foreign import assess_result
from compare.judge.measure import Standard, assess
from compare.mechanics.reference import uncertified
from compare.results.result import read_result
from scenes import Sampling, Settings, Status, from_tables
from tests import scene_files
from tests.comparisons import changed, commanded, sampled
from tests.foreign import Writer, channels

FREE = 10 / (2 * pi)  # Hz, of the mass on its spring
SAMPLES = Sampling(72)


def law(body: str, size: float, frequency: float, start: float = 0.0) -> scene_files.Changes:
    return {"drive": {"body": body, "start": start, "harmonics": [[size, frequency, 0.0]]}}


def pendulum(size: float) -> scene_files.Changes:
    """2 kg at 2 m, hanging, moved by sines at the frequency of small swings: a^2 / 6 of m g l sin a is left."""
    body = {"points": {"O": [0, 0], "T": [2, 0]}, "mass": 2, "com": [2, 0], "inertia": 0}
    swung = law("crank", size, sqrt(9.81 / 2) / (2 * pi), -pi / 2)
    return {"gravity": [0, -9.81], "bodies.crank": body, "sketch": {"angle": -pi / 2, "T": [0, -2]}, **swung}


BALANCED = {  # 5 kg at 0.4 m under a spring without free length from 0.3 m above to 0.2 m: k 0.3 0.2 = m g 0.4
    "gravity": [0, -9.81],
    "ground.points.Q": [0, 0.3],
    "bodies.crank": {"points": {"O": [0, 0], "S": [0.2, 0], "T": [0.8, 0]}, "mass": 5, "com": [0.4, 0], "inertia": 0.3},
    "springs": [{"between": ["ground.Q", "crank.S"], "stiffness": 5 * 9.81 * 0.4 / (0.3 * 0.2), "length": 0}],
    "sketch": {"S": [0.2, 0], "T": [0.8, 0]},
}
MASSES = {"bodies.crank.mass": 1, "bodies.rod.mass": 2, "loads": None}
LEVEL = {"springs": [{"between": ["crank.O", "slider.B"], "stiffness": 4, "length": 1}], **MASSES}
PIEZO = {**MASSES, **law("crank", 5e-5, 50, pi / 2), "sketch": {"angle": pi / 2, "A": [0, 1], "B": [2.8, 0]}}
FAR = {  # 1 um about 50 m along a guide that is 20 m off the origin
    "bodies.mass.slides": {"through": [-12.0, -20.0], "along": [0.6, 0.8]},
    "sketch": {"displacement": 50, "P": [18, 20]},
    **law("mass", 1e-6, 3.0, 50.0),
}
A = 30 * cos(0.4), 30 * sin(0.4)
BESIDE_A_LOCK = {  # the rod is 4e-6 longer than from the crank's highest point to the guide
    **MASSES,
    "gravity": [0, -9.81],
    "bodies.crank.points": {"O": [0, 0], "A": [30, 0]},
    "bodies.rod.lengths": {"A-B": 50.0000761545},
    "bodies.slider.slides.through": [0, -20],
    "sketch": {"angle": 0.4, "A": [*A], "B": [A[0] + 38.4, -20]},
    "drive": {"body": "crank", "speed": 9, "start": 0.4},
}
FLAT = {  # a triangle 3e-7 of its side high: a last place of a length moves its third corner by 1e-11 of the side
    "bodies.coupler": {"lengths": {"B-C": 2.1, "B-T": 0.75, "C-T": 1.35000000000675}, "mass": 3},
    "sketch.T": [2.2, 2.82],
    "loads": None,
}
CLEAN: dict[str, tuple[str, scene_files.Changes]] = {
    "a mass moved as it would move by itself": ("mass_on_spring", {}),
    "3e-5 beside that": ("mass_on_spring", law("mass", 0.1, 1.5915)),
    "a pendulum": ("crank", pendulum(1e-3)),
    "a lever in balance": ("crank", BALANCED),
    "a spring that is always level": ("slider_crank", LEVEL),
    "a stroke of 5e-5 rad": ("slider_crank", PIEZO),
    "a micrometre 50 m away": ("mass_on_spring", FAR),
    "beside a singular pose": ("slider_crank", BESIDE_A_LOCK),
    "a flat triangle": ("loaded_four_bar", FLAT),
}


@sampled(1)
@pytest.mark.parametrize("name", CLEAN)
def test_a_right_core_is_believed(name: str) -> None:
    pytest.importorskip("flint")
    result = check(scene_files.load(*CLEAN[name]), engines=("analytic",), samples=72)
    assert result.verdicts["analytic"] == ("ok", "")
    assert result.ok


def test_friction_is_excused_what_its_joints_are() -> None:
    """A spring of 1e8 N along the crank leaves 1e-8 of the pins' forces, and of the friction by these."""
    pytest.importorskip("flint")
    spring = {"between": ["crank.A", "coupler.B"], "stiffness": 1e9, "length": 0.5}
    pin = {"at": "D", "radius": 0.01, "coefficient": 0.1}
    scene = scene_files.load("loaded_four_bar", {"springs": [spring], "friction": [pin]})
    result = check(scene, engines=("analytic",), samples=72)
    assert result.verdicts["analytic"] == ("ok", "")
    assert result.ok


def test_what_round_off_leaves_of_an_engine_is_named() -> None:
    """A spring of 1e11 N along the crank leaves more of the drive's torque than the 1e-7 that Exudyn promises."""
    spring = {"between": ["ground.A", "crank.B"], "stiffness": 1e12, "length": 0.5}
    scene = scene_files.load("loaded_four_bar", {"springs": [spring]})
    result = check(scene, engines=("analytic", "exudyn"), samples=36, accuracy="exact")
    assert result.verdicts["exudyn"] == ("ok", "")
    (line,) = (line for line in result.reasons if line.startswith("exudyn"))
    assert "where 1e-07 is promised: round-off explains up to" in line
    assert "the spring between ground.A and crank.B, 1e+11 N, cancels in it" in line


@pytest.mark.parametrize(("frequency", "terms"), [(FREE, 10.0), (1.5915, 10 * (1 - (2 * pi * 1.5915 / 10) ** 2))])
def test_a_wrong_effort_is_still_found(frequency: float, terms: float) -> None:
    """Of what the drive has to do half a millionth; where that is nothing, of the spring's 10 N."""
    reference = uncertified(scene_files.load("mass_on_spring", law("mass", 0.1, frequency)))
    assert reference.scale["drive.force"] == pytest.approx(abs(terms), rel=1e-6)
    run = Run("x", Settings("", promise=1e-7), Status.ok, motion=commanded(reference, SAMPLES))
    standard = Standard.of(reference, SAMPLES)
    assert assess(standard, run).run.status is Status.ok
    assert run.motion is not None
    wrong = replace(run, motion=changed(run.motion, "drive.force", 5e-7 * abs(terms)))
    judged = assess(standard, wrong)
    assert (judged.run.status, judged.run.found_by) == (Status.inaccurate, "checks")
    assert judged.errors[-1].unexplained == pytest.approx(5e-7, rel=1e-3)


@pytest.mark.parametrize(("off", "status"), [(0.0, Status.ok), (0.5, Status.inconsistent)])
def test_another_program_of_a_drive_with_nothing_to_do(tmp_path: Path, off: float, status: Status) -> None:
    """Six decimals of its instants are 5e-5 N of the mass's 10 N, and all that it has of the drive's force."""
    scene = scene_files.load("mass_on_spring")
    reference, writer = uncertified(scene), Writer(decimals=".6f")
    columns = writer.columns(scene, SAMPLES.times(scene), [scene.channels.drive.position, *channels(scene)])
    columns["drive.force"] = columns["drive.force"] + off
    result = read_result(scene, f"theirs={writer.file(tmp_path, columns)}")
    assert assess_result(reference, result).run.status is status


def test_what_last_places_leave_is_explained_where_more_than_the_promise_is_left() -> None:
    """3e-5 beside resonance a force is 6e-4 N of 10 N: 1e-13 N are round-off, and 1e-12 N are not."""
    reference = uncertified(scene_files.load("mass_on_spring", law("mass", 0.1, 1.5915)))
    motion = commanded(reference, SAMPLES)
    for off, found in ((2e-15, False), (1e-12, True)):
        errors = estimate(reference.mechanics, changed(motion, "drive.force", off), reference.travel).errors
        assert (errors["drive.force"].max() > 0) == found


def test_a_driven_slider_far_away_is_in_its_place() -> None:
    """A last place of 50 m is 7e-15 m, of a stroke of 2 um 4e-9: more than the 1e-9 that a drive is held to."""
    reference = uncertified(scene_files.load("mass_on_spring", FAR))
    motion = commanded(reference, SAMPLES)
    for off, found in ((np.spacing(50.0), False), (100 * np.spacing(50.0), True)):
        moved = checks(reference.mechanics, changed(motion, "drive.displacement", off), reference.travel)
        assert (moved[0].worst > 1e-9) == found


def test_a_sample_at_which_the_draws_of_last_places_all_but_cancel() -> None:
    """M A w^2 of a mass on a slanted spring is nearly k A: of 128 N 0.0027 N are left, known to about 1e-9 of that.

    At one of 360 samples the few draws of signs move the force by less than doubles do.
    """
    along = [-0.29490899384804375, 0.9555253452146283]
    mass = {"points": {"P": [0, 0]}, "mass": 2.908340219042778}
    scene = from_tables(
        {
            "format": 1,
            "name": "slanted_spring",
            "gravity": [0, -9.81],
            "ground": {"points": {"S": [0.5404544660812485, 0.12378168600958461]}},
            "bodies": {
                "mass": {**mass, "slides": {"through": [0.06137313120434218, 1.6760380343867247], "along": along}}
            },
            "springs": [
                {"between": ["ground.S", "mass.P"], "stiffness": 1300.0635457317499, "length": 1.645475359702889}
            ],
            "drive": {"body": "mass", "harmonics": [[0.19706458225057658, 3.3649772430425307, 0.7648069791215253]]},
            "sketch": {"displacement": 0, "P": [0.06, 1.68]},
            "output": {"slider": "P"},
        }
    )
    assert check(scene, ["analytic"], 360).verdicts["analytic"] == ("ok", "")
