"""The likely cause of a disagreement: of scenes that are wrong on purpose, number, place and amount are named."""

from dataclasses import replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
import pytest

from compare.engines import registry
from compare.engines.registry import Many, SolveMany
from compare.judge.causes import numbers
from compare.judge.causes.cause import Kind
from compare.judge.causes.evidence import evidence
from compare.judge.causes.words import words
from compare.judge.triage import cause, likeliest
from compare.mechanics.reference import Reference, uncertified
from scenes import Instants, Motion, Scene
from scenes.channels import Role
from scenes.model.motion import Samples
from scenes.scene import Force, PressForce
from tests import scene_files
from tests.compare.judge.test_triage import spoilt
from tests.comparisons import SAMPLING, References, commanded, sampled

GRAVITY, INERTIA = "gravity is {percent}", "{place}'s moment of inertia is {inertia}"
WIDTH = "each uniform bar's moment of inertia is that of one {length} wide"


def solved(scene: Scene, reference: Reference) -> Motion:
    motion = registry.reference(scene)(SAMPLING.inputs(reference.scene))
    return Motion({channel: motion[channel] for channel in scene.channels.names()})


INPUTS = {  # what is wrong in a scene, and by which factor
    "mass": ("toggle_press", "bodies.rod.mass", 1.12, Kind.mass, "rod", "12 % too large"),
    "length": ("toggle_press", "bodies.rod.lengths.P4-P5", 1.003, Kind.length, "rod", "0.9 mm too long"),
    "length in m": ("loaded_four_bar", "bodies.rocker.lengths.C-D", 1.01, Kind.length, "rocker", "0.015 m too long"),
    "a hair of a length": (  # by forces as good as the load's table shifted
        *("double_toggle_clamp", "bodies.front_link.lengths.B-C", 1.001),
        *(Kind.length, "front_link", "0.457 mm too long"),
    ),
    "ground": ("toggle_press", "ground.points.P1.*", 1.01, Kind.place, "P1", "4.6 mm off"),
    "load": ("toggle_press", "loads.0.force.*", -1.0, Kind.load, "P5", "of the opposite sign"),
    "gravity": ("quick_return", "gravity.*", -1.0, Kind.gravity, "all", "of the opposite sign"),
    "guide": ("quick_return", "bodies.ram.slides.through.*", 1.02, Kind.guide, "ram", "2.99 mm beside its place"),
    "stiffness": ("driven_toggle", "springs.0.stiffness", 1.1, Kind.spring, "S-K", "stiffness is 10 % too large"),
    "table": ("driven_toggle", "loads.0.table.*.1", 0.9, Kind.load, "C", "10 % too small"),
}


def times(factor: float, scene: Scene, paths: str) -> Scene:
    """Return a scene with some numbers times a factor."""
    numbers = {path: factor * one.value for path, one in scene.numbers.items() if fnmatchcase(path, paths)}
    assert numbers
    return scene.with_numbers(numbers)


@sampled(3)
@pytest.mark.parametrize("fault", INPUTS)
def test_what_is_wrong_in_a_scene_is_named_with_its_amount(references: References, fault: str) -> None:
    name, paths, factor, kind, place, amount = INPUTS[fault]
    reference = references(name)
    named = cause(reference, SAMPLING, solved(times(factor, reference.scene, paths), reference))
    sentence = words(reference.scene, named)
    assert (named.kind, named.place, named.others) == (kind, place, ()), sentence
    assert sentence.endswith(f" {amount}")


def test_what_has_no_number_in_the_scene_is_named(references: References) -> None:
    reference = references("toggle_press")
    scene = reference.scene
    rod = scene.bodies["rod"]
    about_end = replace(rod, com=(0.15, 0.0), inertia=60 * 0.3**2 / 3)
    named = cause(reference, SAMPLING, solved(replace(scene, bodies={**scene.bodies, "rod": about_end}), reference))
    assert words(scene, named) == "rod's moment of inertia is that about its end"
    assert (named.kind, named.place) == (Kind.inertia, "rod")
    assert named.amounts == pytest.approx((3.0,))
    named = cause(reference, SAMPLING, solved(replace(scene, loads=()), reference))
    assert words(scene, named) == "the load at P5 is missing"
    force = 1e4 * np.sign(commanded(reference)["P5.vy"])  # against the motion of the slider
    motion = commanded(reference)
    slow = motion["P5.vy"] * force / reference.scene.drive.law.at(motion["time"]).rate
    named = cause(reference, SAMPLING, spoilt(motion, {"drive.torque": motion["drive.torque"] + slow}))
    assert (named.kind, named.place) == (Kind.friction, "slider")


def test_swapped_masses_where_a_moment_of_inertia_is_given(references: References) -> None:
    reference = references("loaded_four_bar")
    masses = {"bodies.crank.mass": 3.0, "bodies.coupler.mass": 2.0}
    named = cause(reference, SAMPLING, solved(reference.scene.with_numbers(masses), reference))
    assert words(reference.scene, named) == "the masses of coupler and crank are swapped"


@sampled(1)
@pytest.mark.parametrize("only", ["", "drive.torque"])
def test_several_numbers_that_are_off_at_once(references: References, only: str) -> None:
    """Bars that are no lines but 100 mm wide, and another gravity; at 8 digits, as another program writes its own."""
    reference = references("loaded_four_bar")
    scene = reference.scene
    bodies = dict(scene.bodies)
    for name, length in (("crank", 0.6), ("rocker", 1.5)):
        mass = bodies[name].mass or 0.0
        bodies[name] = replace(bodies[name], com=(length / 2, 0.0), inertia=mass * (length**2 + 0.01) / 12)
    gravity = (0.99966 * 0.5, -0.99966 * 9.81)
    other = solved(replace(scene, bodies=bodies, gravity=gravity), reference)
    theirs = {c: np.round(v, 8) for c, v in other.samples.items()}
    kept = {"time", scene.channels.drive.position, only} if only else {*theirs}
    asked = Instants(tuple(theirs["time"]), channels=frozenset(kept) - {"time", scene.channels.drive.position})
    right = commanded(reference)
    given = {c: theirs[c] if c in kept - {"time", scene.channels.drive.position} else right[c] for c in kept}
    named = likeliest(evidence(reference, replace(asked, instants=tuple(right["time"])), Motion(given)))
    ways = [{one.text: one.amounts[0] for one in (each, *each.besides)} for each in (named, *named.others)]
    expected = {GRAVITY: -0.00034, WIDTH: 0.1}
    assert any(way == pytest.approx(expected, rel=1e-2) for way in ways if way.keys() == expected.keys()), ways
    others = [way for way in ways if way.keys() != expected.keys()]
    assert [way.keys() for way in others] in ([], [{GRAVITY, INERTIA}]), "the crank turns evenly, wide or not"


def test_a_guide_that_is_turned_by_a_hair_makes_nothing_late(references: References) -> None:
    reference = references("toggle_press")
    path = "bodies.slider.slides.along"
    x, y = (reference.scene.numbers[f"{path}.{axis}"].value for axis in (0, 1))
    other = reference.scene.with_numbers({f"{path}.0": x - 1e-4 * y, f"{path}.1": y + 1e-4 * x})
    named = cause(reference, SAMPLING, solved(other, reference))
    assert (named.kind, named.place, named.others) == (Kind.guide, "slider", ()), words(reference.scene, named)
    assert named.amounts == pytest.approx((1e-4,), rel=1e-3)


def test_a_load_that_is_switched_late_is_named(references: References) -> None:
    """Each row with the whole press force or with none, as it was two samples before."""
    reference = references("quick_return")
    scene, motion = reference.scene, commanded(reference)
    (load,) = (one for one in scene.loads if isinstance(one, PressForce))
    always = solved(replace(scene, loads=(Force(load.body, load.at, load.force),)), reference)
    never = solved(replace(scene, loads=()), reference)
    acts = np.roll(reference.acts(motion)[0][0], 2)
    wrong = {c: np.where(acts, always[c], never[c]) for c in scene.channels.names(Role.force)}
    named = cause(reference, SAMPLING, spoilt(motion, wrong))
    assert (named.kind, named.place) == (Kind.load, load.at)
    assert named.amounts == pytest.approx((2 * 1.5 / 72,))


@sampled(1)
@pytest.mark.parametrize(("changed", "said"), [(("force.*", 0.5), "50 % too small"), (("last", 4.0), "last 2.23 mm")])
def test_a_press_force_that_acts_next_to_its_end_alone(changed: tuple[str, float], said: str) -> None:
    """Of the motion only samples beside its switches are off, where elsewhere the side of the switch is a rounding."""
    reference = uncertified(scene_files.load("crank_press", {"loads.0.last": 0.5}))
    wrong = times(changed[1], reference.scene, f"loads.0.{changed[0]}")
    named = cause(reference, SAMPLING, solved(wrong, reference))
    assert (named.kind, named.place) == (Kind.load, "B")
    assert words(reference.scene, named).endswith(said)


def test_of_many_bodies_a_length_is_sought_at_few_samples(
    references: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    reference = references("toggle_press")
    _, path, factor, kind, place, amount = INPUTS["length"]
    motion = solved(times(factor, reference.scene, path), reference)
    rows = list[int]()

    def counted(*of: Any) -> SolveMany:
        def solve(position: Samples, time: Samples) -> Many:
            rows.append(position.shape[-1])
            return machines(position, time)

        machines = many(*of)
        return solve

    many = registry.many
    monkeypatch.setattr(registry, "many", counted)
    monkeypatch.setattr(numbers, "MAX_SLOPE_NUMBERS", 2.8e4)
    named = cause(reference, SAMPLING, motion)
    assert (named.kind, named.place) == (kind, place)
    assert words(reference.scene, named).endswith(amount)
    assert 10 < max(rows) < 25
