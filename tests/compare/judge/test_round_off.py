"""What doubles explain: tight where a linkage is far from a lock, wide next to one, and never an excuse for NaN."""

from dataclasses import replace

import numpy as np
import pytest

from analytic.way.singular import Meetings
from compare import check
from compare.engines import registry
from compare.judge.checks import checks
from compare.judge.errors import compare, error_table
from compare.mechanics import mechanics as sensitivity
from compare.mechanics.constraints import Constraints
from compare.mechanics.mechanics import EPS, Mechanics
from compare.mechanics.reference import Floor, Reference, uncertified
from compare.mechanics.round_off import Explained, explain
from scenes import Sampling, Scene, hard
from scenes.channels import named
from tests import scene_files
from tests.comparisons import SAMPLING, changed, commanded, row_of, sampled

TURN = Sampling(360)


def rung(name: str, label: str) -> Scene:
    return next(of for of in hard.ladder(name).rungs if of.label == label).scene()


def largest(explained: Explained, *quantities: str) -> float:
    return max(float(s.max()) for channel, s in explained.sensitivity.items() if named(channel).name in quantities)


def test_far_from_a_lock_little_is_explained(reference: Reference) -> None:
    explained = explain(reference, SAMPLING)
    assert 20 < explained.condition.max() < 50
    assert largest(explained, "ax", "ay", "fx", "fy") <= 1e-12
    assert explained.decidable


def test_it_grows_towards_a_lock_as_theory_has_it() -> None:
    """The condition as 1/sqrt(g), an angular acceleration as 1/g of its own size there."""
    far, near = (explain(uncertified(rung("lock_rrr", label)), TURN) for label in ("1e-3", "1e-7"))
    assert near.condition.max() / far.condition.max() == pytest.approx(1e2, rel=0.3)
    ratio = largest(near, "alpha") / largest(far, "alpha")
    assert 1e3 < ratio < 1e5
    assert near.decidable


def test_a_few_draws_find_nearly_the_worst(monkeypatch: pytest.MonkeyPatch) -> None:
    few = explain(uncertified(rung("lock_rrr", "1e-5")), TURN)
    monkeypatch.setattr(sensitivity, "DRAWS", 60)
    many = explain(uncertified(rung("lock_rrr", "1e-5")), TURN)
    for quantities in (("x", "y"), ("vx", "vy"), ("ax", "ay"), ("fx", "fy")):
        assert largest(few, *quantities) >= largest(many, *quantities) / 3


def test_in_a_lock_doubles_can_tell_nothing() -> None:
    """The change point itself, where scenes that differ by nothing to speak of do not assemble, or jump."""
    scene = rung("parallelogram", "0")
    solve = registry.reference(scene)
    vars(solve)["meetings"] = Meetings(0.0, 0.0, ())  # which else keep it from being solved
    motion = solve(TURN.inputs(scene))
    scale = dict.fromkeys(scene.channels.names(), 1.0)
    assert not explain(Reference(Mechanics(scene), solve, 1.0, {}, scale, Floor({}, "")), TURN).decidable
    assert Constraints(scene).condition(motion).max() > 1e15


def test_the_allowance_is_a_few_roundings(reference: Reference) -> None:
    """The largest of three figures: 1e-13 is a fault of a pin's force, and none of the torque that these leave."""
    explained, motion = explain(reference, SAMPLING), commanded(reference)
    pins = np.abs([motion[channel] for channel in motion.samples if channel.endswith((".fx", ".fy"))]).max(axis=0)
    strongest = np.maximum(pins, 1e5)  # N, of the slider; the press has no stronger weight or inertia
    moment = (
        strongest
        * reference.mechanics.size
        / np.maximum(reference.scale["drive.torque"], np.abs(motion["drive.torque"]))
    )
    assert explained.terms["drive.torque"] == pytest.approx(moment)
    assert 1 < explained.terms["drive.torque"].max() < 20
    for channel, moved in explained.sensitivity.items():
        allowed, times = explained.error(channel), np.maximum(explained.terms.get(channel, 1.0), 1.0)
        assert np.array_equal(allowed, np.maximum(2.0**-52 * explained.condition * times, moved))
        most = 1000 if channel in ("drive.torque", "slider.guide_moment") else 300
        assert 20 * 2.0**-52 < allowed.max() < most * 2.0**-52, channel  # measured: 43 to 208, and 787 of them
    wrong = changed(motion, "P3.fx", 1e-13 * reference.scale["P3.fx"])
    table = [*error_table("x", compare(reference, SAMPLING, wrong), reference, explained)]
    assert row_of(table, "P3.fx").unexplained == pytest.approx(1e-13, rel=0.2)  # less a few roundings


def test_an_error_is_a_fault_only_above_it(reference: Reference) -> None:
    """At one row where much is explained, and at another where nothing is."""
    motion, plain, size = commanded(reference), explain(reference, SAMPLING), reference.scale["P3.fx"]
    hazy = {channel: np.where(np.arange(SAMPLING.count) == 40, 1e-3, of) for channel, of in plain.sensitivity.items()}
    explained = replace(plain, sensitivity=hazy)

    def unexplained(row: int, by: float) -> float:
        comparison = compare(reference, SAMPLING, changed(motion, "P3.fx", by * size, row))
        return row_of([*error_table("x", comparison, reference, explained)], "P3.fx").unexplained

    assert unexplained(40, 0.9e-3) <= 1e-14  # of which no more than the floor is shown
    assert unexplained(40, 1.1e-3) == pytest.approx(1.1e-3)
    assert unexplained(41, 1e-6) == pytest.approx(1e-6)
    assert np.isnan(unexplained(40, np.nan))


def test_the_condition_is_that_of_the_matrix_that_moves_the_linkage(reference: Reference) -> None:
    """Its inverse turns a gap at any joint into a change of pose: by at most the largest singular value's inverse."""
    motion, constraints = commanded(reference), Constraints(reference.scene)
    values = np.linalg.svd(constraints.jacobian(constraints.poses(motion))[7], compute_uv=False)
    found = reference.mechanics.constraints.condition(motion)
    assert found[7] == pytest.approx(values[0] / values[-1])
    assert EPS * found.max() <= 1e-14


ALONG, SQUARE = (np.cos(0.3), np.sin(0.3)), np.radians(0.1)
MASSES = {"bodies.crank.mass": 1, "bodies.rod.mass": 1}
SHORT = {
    "bodies.slider.slides.along": [float(x) for x in ALONG],
    "drive": {"body": "crank", "speed": 1, "start": 1.0, "end": 1.0002},
    "sketch": {"angle": 0.3, "A": [float(x) for x in ALONG], "B": [float(4 * x) for x in ALONG]},
}


def away(x: float, y: float) -> scene_files.Changes:
    """Return changes that put the toggle press somewhere else, mm."""
    sketch = {"P2": [480, -202], "P3": [0, -300], "P4": [0, -790], "P5": [0, -1090]}
    return {
        "ground.points": {"O": [x, y], "P1": [x + 404.709, y - 217.661]},
        "bodies.slider.slides.through": [x, y],
        "sketch": {"angle": 11.5, **{point: [x + u, y + v] for point, (u, v) in sketch.items()}},
    }


GUIDE = float(1 - 3 * np.cos(SQUARE))  # m: its height, where the rod is so far from square to it at the end
STEEP = {
    "bodies.slider.slides.through": [0, GUIDE],
    "drive": {"body": "crank", "speed": 1, "start": 0.9, "end": float(np.pi / 2)},
    "sketch": {"angle": 0.9, "A": [0.62, 0.78], "B": [2, GUIDE]},
}
STRONG = {"springs": [{"between": ["ground.A", "crank.B"], "stiffness": 1e9, "length": 0.5}]}
DOUBLES: dict[str, tuple[str, scene_files.Changes, str]] = {
    "a stroke of a hundredth of a degree": ("slider_crank", {**MASSES, **SHORT}, "last places"),
    "a kilometre from the origin": ("toggle_press", away(1e6, 7e5), "last places"),
    "a hundred kilometres from the origin": ("toggle_press", away(1e8, 7e7), "last places"),
    "a rod nearly square to its guide": ("slider_crank", {**MASSES, **STEEP}, "last places"),
    "a spring along the crank": (
        "loaded_four_bar",
        STRONG,
        "the spring between ground.A and crank.B, 1e+08 N, cancels",
    ),
}


@sampled(1)
@pytest.mark.parametrize("name", DOUBLES)
def test_where_doubles_are_the_limit_that_is_the_reason_and_not_the_core(name: str) -> None:
    pytest.importorskip("flint")
    scene, changes, why = DOUBLES[name]
    result = check(scene_files.load(scene, changes), engines=("analytic",), samples=72)
    assert result.verdicts["analytic"] == ("ok", "")
    assert result.ok
    assert f"all that doubles leave of {'drive.torque: ' if 'spring' in why else ''}" in result.agreement.sentence
    assert why in result.agreement.sentence


def test_what_cancels_explains_round_off_alone() -> None:
    """A spring of 1e8 N along a crank of 0.6 m that turns under some 100 N m: 1e8 N leaves less than 1e-6 N m."""
    strong = explain(uncertified(scene_files.load("loaded_four_bar", STRONG)), SAMPLING)
    usual = explain(uncertified(scene_files.load("loaded_four_bar")), SAMPLING)
    assert 1e-12 < strong.error("drive.torque").max() < 1e-7
    assert usual.error("drive.torque").max() < 1e-12


def test_a_gap_in_a_guide_above_round_off_is_seen() -> None:
    reference = uncertified(scene_files.load("slider_crank", {**MASSES, **SHORT}))
    motion = commanded(reference)
    for off, seen in ((0.0, False), (100 * EPS * 4, True)):  # m, of places at 4 m
        moved = changed(changed(motion, "B.x", -off * ALONG[1]), "B.y", off * ALONG[0])
        gaps = [c for c in checks(reference.mechanics, moved, reference.travel) if c.check == "closure"]
        (gap,) = (c.worst for c in gaps if c.of == "slider")
        assert (gap > 0) == seen
