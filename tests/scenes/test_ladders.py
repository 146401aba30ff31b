"""The ladders of hard scenes: that each reads, is what its labels say, and ends as it says."""

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import scenes
from compare.engines.runner import Run, run
from scenes import InputError, Motion, Sampling, Status, hard
from scenes.channels import named
from scenes.hard import Ladder, Rung
from scenes.scene import ConstantSpeed
from tests import scene_files
from tests.comparisons import sampled

NAMES = (*hard.catalogue(), *hard.catalogue(long=True))
TURNS_ENOUGH = 100  # of the core's samples, which do not know of each other; more only take longer
DECADES = [f"1e-{k}" for k in range(1, 10)]
PLAIN_LOCKS = ("lock_rrp", "lock_rrr", "lock_rrr_folded", "lock_rpr", "parallelogram")
LOCKS = (*PLAIN_LOCKS, "kite", "kite_long", "dead_centre_driven")
MINE = (scene_files.FOLDER / "ladders" / "rod.toml").read_text(encoding="utf-8")


@pytest.fixture(params=NAMES)
def ladder(request: pytest.FixtureRequest) -> Ladder:
    return hard.ladder(request.param)


def solved(rung: Rung) -> Run:
    return run("analytic", rung.scene(), Sampling(360, min(rung.turns, TURNS_ENOUGH)))


def motion_of(ran: Run) -> Motion:
    assert ran.motion is not None
    return ran.motion


def peak(rung: Rung, *quantities: str) -> float:
    """The largest magnitude of any channel of these quantities."""
    samples = motion_of(solved(rung)).samples
    return max(float(np.abs(values).max()) for channel, values in samples.items() if named(channel).name in quantities)


def test_ladders_are_no_shipped_scenes_and_long_ones_apart() -> None:
    assert not set(scenes.shipped()) & set(NAMES)
    assert not any("hard" in path.parts for path in scenes.shipped().values())
    assert "turns_long" in hard.catalogue(long=True)
    assert not set(hard.catalogue()) & set(hard.catalogue(long=True))
    assert max(rung.turns for name in hard.catalogue() for rung in hard.ladder(name).rungs) <= 100
    assert [rung.turns for rung in hard.ladder("turns_long").rungs] == [1000, 10000]


def test_a_ladder_says_everything(ladder: Ladder) -> None:
    assert ladder.name in NAMES
    texts = ladder.file.title, ladder.file.parameter, ladder.file.expected, ladder.file.why
    assert all(text and "\n" not in text for text in texts)
    assert len({rung.label for rung in ladder.rungs}) == len({rung.value for rung in ladder.rungs}) == len(ladder.rungs)
    assert pickle.loads(pickle.dumps(ladder)) == ladder


@sampled(6)
def test_the_reference_ends_as_expected(ladder: Ladder) -> None:
    for rung in ladder.rungs:
        if rung.status == hard.INVALID:
            with pytest.raises(InputError, match="over-constrained"):
                rung.scene()
        else:
            ran = solved(rung)
            assert ran.status.name == rung.status, f"{rung.label}: {ran.reason}"


def test_part_of_a_turn_keeps_clear_of_a_change_point() -> None:
    """The kite's is at 0 deg; without it, and on the way back from beyond it, there is one motion."""
    (rung,) = (rung for rung in hard.ladder("kite_passed").rungs if rung.label == "0.5 deg")
    scene = rung.scene()
    assert isinstance(scene.drive.law, ConstantSpeed)
    away = scene.with_law(replace(scene.drive.law, start=np.radians(30), end=np.radians(330)))
    assert run("analytic", away, Sampling(360)).status is Status.ok
    across = scene.with_law(replace(scene.drive.law, start=np.radians(-30.3), end=np.radians(30)))
    crossing = run("analytic", across, Sampling(360))
    assert crossing.status is Status.cannot_assemble
    assert "two ways of assembling the bodies meet at crank angle 0.0000 deg" in crossing.reason.replace("-0.0", "0.0")


@sampled(2)
@pytest.mark.parametrize("name", LOCKS)
def test_the_distance_to_the_lock_is_the_label(name: str) -> None:
    """To 6e-16 m: three roundings of lengths of up to 1.5 m, of the file's and of their sum; 6e-7 of the last rung."""
    rungs = [rung for rung in hard.ladder(name).rungs if rung.status == "ok"]
    for rung in rungs:
        samples = motion_of(solved(rung)).samples
        (nearest,) = (values.min() for channel, values in samples.items() if named(channel).name == "to_lock")
        assert nearest == pytest.approx(float(rung.label), abs=6e-16, rel=0)
    if not name.startswith("kite"):
        assert [rung.label for rung in rungs] == DECADES


# By how many powers of ten the accelerations and the reactions grow with each one of the distance to a lock.
GROWTH = dict.fromkeys(PLAIN_LOCKS, (0.5, 1.0)) | {"dead_centre_driven": (1.5, 2.0)}


@sampled(2)
@pytest.mark.parametrize("name", GROWTH)
def test_peaks_grow_as_the_ladder_says(name: str) -> None:
    """Over the last decade but for terms of the next order, the square root of 1e-8."""
    near, nearest = (rung for rung in hard.ladder(name).rungs if rung.label in DECADES[-2:])
    grown = [np.log10(peak(nearest, *of) / peak(near, *of)) for of in (("ax", "ay", "alpha"), ("fx", "fy"))]
    assert grown == pytest.approx(GROWTH[name], abs=1e-3)


def test_the_kite_whirls_as_the_ladder_says() -> None:
    rungs = [rung for rung in hard.ladder("kite").rungs if rung.status == "ok"]
    for rung in rungs:
        assert peak(rung, "omega") == pytest.approx(2 * np.pi * 0.5 / float(rung.label), rel=1e-9)


@pytest.mark.parametrize("name", ["sketch_rrp", "sketch_rrr"])
def test_the_sketch_changes_nothing(name: str) -> None:
    first, *others = (motion_of(solved(rung)) for rung in hard.ladder(name).rungs)
    for other in others:
        assert all((other[channel] == first[channel]).all() for channel in first.samples)


@pytest.mark.parametrize(("name", "link"), [("sketch_rrp", 0.5), ("sketch_rrr", 1.0)])
def test_the_sketch_is_exact_but_for_what_is_said(name: str, link: float) -> None:
    """The nearest rung is off by 1e-12 of the link's length, m; rounding leaves 2e-16."""
    rung = hard.ladder(name).rungs[0]
    scene = rung.scene()
    assert isinstance(scene.drive.law, ConstantSpeed)
    there = scene.with_law(replace(scene.drive.law, start=scene.sketch.drive))
    drawn = motion_of(run("analytic", there, Sampling(1)))
    off = [np.hypot(drawn[f"{p}.x"][0] - x, drawn[f"{p}.y"][0] - y) for p, (x, y) in scene.sketch.points.items()]
    assert rung.label == "1e-12"
    assert max(off) == pytest.approx(1e-12 * link, abs=2e-16)


@pytest.mark.parametrize("name", ["dead_point_toggle", "dead_point_press"])
def test_the_slider_stands_still_at_its_dead_points(name: str) -> None:
    """Its velocity there is its acceleration's times how long the crank takes for what the label says it is off."""
    for rung in hard.ladder(name).rungs:
        scene, motion = rung.scene(), motion_of(solved(rung))
        v, a = motion[f"{scene.output}.vy"], motion[f"{scene.output}.ay"]
        off = float(rung.label.split()[2]) if rung.label.endswith("deg") else 0.0
        expected = abs(a[0]) * np.radians(off) / scene.drive.law.peak_rate
        # 1e-14 by rounding of an angle of 5 rad; the next term of the series is 1e-3 deg times a number of order one
        assert abs(v[0]) == pytest.approx(expected, rel=1e-4, abs=1e-14 * np.abs(v).max())


def test_a_press_force_that_no_sample_meets_is_in_none() -> None:
    forces = [peak(rung, "fx", "fy") for rung in hard.ladder("press_last").rungs]
    assert min(forces[:-2]) > 1.59e6
    assert max(forces[-2:]) < 5e3


def test_each_turn_is_as_the_first() -> None:
    """The core drifts by what the angle is off: three roundings, of the turns, of 2 pi and of their product."""
    *_, rung = hard.ladder("turns").rungs
    motion = motion_of(solved(rung))
    y = motion["P5.y"]
    assert y.shape == (36001,)
    first, last = y[:361], y[-361:]
    fastest = np.abs(motion["P5.vy"]).max() / (2 * np.pi)  # m a radian
    assert np.abs(last - first).max() <= 3 * 100 * 2 * np.pi * 2**-53 * fastest + 4 * 2**-53


def test_a_ladder_of_ones_own(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(MINE, encoding="utf-8")
    mine = hard.ladder(file)
    assert mine.name == "mine"
    ends = {"shorter": (290, 1, "ok"), "as_is": (300, 1, "ok"), "locking": (20, 1, "cannot_assemble")}
    assert {rung.label: (rung.value, rung.turns, rung.status) for rung in mine.rungs} == ends
    assert [solved(rung).status.name for rung in mine.rungs] == ["ok", "ok", "cannot_assemble"]


def test_a_scene_beside_the_ladder(tmp_path: Path) -> None:
    (tmp_path / "press.toml").write_bytes(scenes.shipped()["toggle_press"].read_bytes())
    file = tmp_path / "mine.toml"
    file.write_text(MINE.replace('"toggle_press"', '"press.toml"'), encoding="utf-8")
    assert hard.ladder(file).rungs[0].scene().file == f"{tmp_path / 'press.toml'}, bodies.rod.lengths.P4-P5 = 290"


@pytest.mark.parametrize("name", ["lock_rpr_", "no/such.toml"])
def test_no_such_ladder(name: str) -> None:
    with pytest.raises(InputError, match=r"no such ladder or file.*(did you mean 'lock_rpr'|one of)"):
        hard.ladder(name)


@pytest.mark.parametrize(("path", "value", "kind"), [("drive.speed", "60", "text"), ("units.length", 1.0, "number")])
def test_what_is_changed_keeps_its_kind(path: str, value: float | str, kind: str) -> None:
    with pytest.raises(InputError, match=f"{path}: expected the path of a {kind}"):
        scenes.load("toggle_press", {path: value})


def test_two_rungs_are_told_apart_in_messages() -> None:
    near, nearest = (rung for rung in hard.ladder("lock_rrr").rungs if rung.label in DECADES[-2:])
    assert near.scene().file.endswith("= 0.50000001")
    assert nearest.scene().file.endswith("= 0.500000001")
