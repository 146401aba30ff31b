"""Names choose no numbers: points, bodies, pins, channels and magnitudes may be called alike, or as other things."""

import numpy as np
import pytest

import analytic
from compare.engines import registry
from compare.judge.proof import MET, MISSED, held
from scenes import Failure, Motion, Sampling, Scene, Status
from tests import scene_files
from tests.comparisons import SLOW, sampled
from tests.naming import alike, loaded
from tests.sim_models.formulations import run

FEW = Sampling(6)
# Among them dyads of every kind whose inner joint is a slide, larger groups, a drive between bodies, friction, springs.
EVERY = (
    *("quick_return", "carried_yoke", "cross_slide", "three_at_a_pin"),
    *(pytest.param(name, marks=SLOW) for name in ("elements", "swinging_law", "slotted_class_iii")),
    *(pytest.param(name, marks=SLOW) for name in ("crank_press_friction", "crank_on_carriage")),
    *(pytest.param(name, marks=pytest.mark.study) for name in ("gas_spring", "scotch_yoke", "elbow", "driven_toggle")),
)
SLIDES = "carried_yoke", "cross_slide"  # their dyads are named by sliders
OTHERS = ("casadi", "mujoco", "pymunk")
NAMED = ("quick_return", *(pytest.param(name, marks=SLOW) for name in (*SLIDES, "toggle_press_friction", "class_iii")))


def numbers(motion: Motion) -> list[bytes]:
    """All numbers of a motion, whose channels are in the order of the files."""
    return [values.tobytes() for values in motion.samples.values()]


@sampled(2)
@pytest.mark.parametrize("name", EVERY)
def test_the_core_finds_the_same_numbers(name: str) -> None:
    scene = scene_files.load(name)
    expected = numbers(registry.motion(scene, FEW))
    for label, other in alike(scene):
        found = registry.motion(other, FEW)
        assert numbers(found) == expected, label
        names = {*other.channels.names(), *other.channels.magnitudes}
        assert len(names) == len(scene.channels.names()) + len(scene.channels.magnitudes), label


@pytest.mark.parametrize("name", NAMED)
def test_bounds_are_the_same(name: str) -> None:
    scene = scene_files.load(name)
    expected = np.array([row[2:] for row in analytic.enclose(scene, accuracy=1e-2).rows])
    for label, other in [*alike(scene)][3:6]:
        rows = np.array([row[2:] for row in analytic.enclose(other, accuracy=1e-2).rows])
        assert rows.shape == expected.shape, label
        # Lines of one topology are recorded alike, so that nothing but the order of equal sums may differ.
        assert np.allclose(rows, expected, rtol=1e-6, atol=1e-9), label


@sampled(1)
@pytest.mark.parametrize("engine", ["exudyn", "pinocchio", *(pytest.param(name, marks=SLOW) for name in OTHERS)])
@pytest.mark.parametrize(
    "name",
    [
        "quick_return",
        pytest.param("carried_yoke", marks=SLOW),
        pytest.param("cross_slide", marks=pytest.mark.study),
    ],
)
def test_other_models_find_the_same_numbers(engine: str, name: str) -> None:
    pytest.importorskip(registry.ENTRIES[engine].package)
    scene, module = scene_files.load(name), registry.engine(engine)

    def outcome(scene: Scene) -> object:
        try:
            return numbers(run(module, scene, module.FAST, FEW))
        except Failure as failure:  # pymunk's few sweeps leave a joint of one scene open
            return failure.status, failure.reason

    expected = outcome(scene)
    for label, other in [*alike(scene)][::6]:
        assert outcome(other) == expected, label


def test_machines_and_derivatives_are_the_same() -> None:
    scene, x = scene_files.load("quick_return"), np.linspace(0.0, 1.0, 3)
    path = "bodies.crank.mass"
    body = [*scene.bodies].index("crank")

    def found(scene: Scene) -> list[bytes]:
        own = path.replace("crank", [*scene.bodies][body])
        many = analytic.solve_many(scene, {own: [1.0, 2.0]}, x)
        assert {*many.status} == {Status.ok}
        by = analytic.derivatives(scene, [own], x)
        return [np.asarray(values).tobytes() for values in (*many.samples.values(), *by.values())]

    expected = found(scene)
    assert all(found(other) == expected for _, other in [*alike(scene)][2:4])


# A slider-crank that its slider drives, with the rod's pin on it at P. In the frame of the slider the rod is a massless
# bar: with Q on the slider and a mass on the crank's pin alone the drive's force is not the pin's.
DRIVEN = {
    "format": 1,
    "name": "driven",
    "ground": {"points": {"O": [0, 0]}},
    "bodies": {
        "crank": {"points": {"O": [0, 0], "A": [0.15, 0]}, "mass": 1},
        "rod": {"points": {"A": [0, 0], "P": [0.2, 0]}, "mass": 2},
        "slider": {"points": {"P": [0, 0]}, "mass": 5, "slides": {"through": [0, 0], "along": [1, 0]}},
    },
    "drive": {"body": "slider", "speed": 0.1, "start": 0.2, "end": 0.3},
    "loads": [{"body": "slider", "at": "P", "force": [-1000, 0]}],
    "sketch": {"displacement": 0.25, "A": [0.09, 0.12], "P": [0.25, 0]},
    "output": {"slider": "P"},
}
SAME = {name: name for name in ("O", "A", "crank", "rod", "slider")}


def test_a_limit_of_the_drive_is_not_of_a_pin_called_drive() -> None:
    """The load alone asks the drive for 1000 N, of which the pin has nothing but inertia's few newtons."""
    scene = loaded(
        DRIVEN, {**SAME, "P": "drive"}, SAME, {"drive.force": {"most": 500}, "drive/slider.force": {"most": 500}}
    )
    both = [*held(scene, Sampling(), analytic.enclose(scene))]
    assert [limit.outcome for limit in both] == [MISSED, MET]
    assert both[0].enclosure.low == pytest.approx(1000, rel=0.05)  # of 5 kg at some 0.1 m/s^2 no more
    motion = registry.motion(scene, FEW)
    most = np.hypot(motion["drive.fx"], motion["drive.fy"]).max()
    assert 0 < most <= both[1].enclosure.high <= 50
