"""By how much engines differ on the designer's numbers: of motions that are wrong in one thing."""

from dataclasses import replace

import numpy as np
import pytest

from compare.judge.measure import measure
from compare.judge.peaks.peaks import peaks
from compare.mechanics.reference import Reference, uncertified
from scenes import Motion, Sampling
from scenes.channels import Role
from scenes.model.inputs import passing
from scenes.scene import Force
from tests import scene_files
from tests.comparisons import SAMPLING, Plug, commanded, of_scene

ROUNDING = 1e-13  # of numbers: some roundings


def differences(reference: Reference, motion: Motion, plug: Plug, sampling: Sampling = SAMPLING) -> dict[str, float]:
    """Return by number how far the motion is off."""
    plug(motion)
    found = peaks(reference, sampling, [measure(reference, "stub", sampling)])
    return {peak.name: peak.differs["stub"] for peak in found if "stub" in peak.differs}


def with_changed(motion: Motion, channels: tuple[str, ...], by: float, rows: slice = slice(None)) -> Motion:
    """Return the motion with some channels larger by a share."""
    samples = dict(motion.samples)
    for channel in channels:
        samples[channel] = samples[channel].copy()
        samples[channel][rows] *= 1 + by
    return Motion(samples)


def test_samples_far_apart_are_no_difference(reference: Reference, plug: Plug) -> None:
    few = Sampling(24)
    off = differences(reference, commanded(reference, few), plug, few)
    assert len(off) == 23
    assert max(off.values()) <= ROUNDING


DRIVE = {f"peak {way} {of}" for way in ("driving", "braking") for of in ("torque", "power")}
DRIVE |= {"RMS drive torque"}  # the work is zero
DIFFERS = {  # where some channels are off
    ("P3.fx", "P3.fy"): {"largest force at P3"},
    ("slider.guide_force",): {"largest guide force at slider"},
    ("drive.torque",): DRIVE,
    ("P5.vy",): {"peak speed"},
    ("P5.ay",): {"peak acceleration"},
}


@pytest.mark.parametrize("channels", DIFFERS)
def test_what_is_off_differs_and_nothing_else(reference: Reference, plug: Plug, channels: tuple[str, ...]) -> None:
    off = differences(reference, with_changed(commanded(reference), channels, 1e-3), plug)
    assert {name for name, by in off.items() if by > ROUNDING} == DIFFERS[channels]
    assert max(off.values()) == pytest.approx(1e-3, rel=1e-6)


def test_work_is_relative_to_the_peak_torque(reference: Reference, plug: Plug) -> None:
    motion = commanded(reference)
    torque = motion["drive.torque"]
    off = differences(reference, Motion({**motion.samples, "drive.torque": torque + 1e-4 * np.abs(torque).max()}), plug)
    assert off["work a turn"] == pytest.approx(1e-4, rel=1e-9)


def test_places_are_relative_to_the_stroke(reference: Reference, plug: Plug) -> None:
    motion = commanded(reference)
    off = differences(reference, Motion({**motion.samples, "P5.y": motion["P5.y"] + 1e-4 * reference.stroke}), plug)
    assert off["closed dead point"] == pytest.approx(1e-4, rel=1e-2)  # over the stroke of these samples
    assert off["open dead point"] == off["closed dead point"]
    assert off["stroke"] <= ROUNDING


def test_a_drive_that_is_late_makes_no_difference(reference: Reference, plug: Plug) -> None:
    scene = reference.scene
    late = reference.at(passing(scene, SAMPLING.commanded(scene) - 0.01, SAMPLING.times(scene)))
    assert max(differences(reference, late, plug).values()) <= ROUNDING


@pytest.mark.parametrize("turn", [0, 1, 2])
def test_the_worst_turn_counts(reference: Reference, plug: Plug, turn: int) -> None:
    long = Sampling(72, 3)
    rows = slice(72 * turn + 1, 72 * (turn + 1))
    wrong = with_changed(commanded(reference, long), ("P3.fx", "P3.fy"), 1e-3, rows)
    assert differences(reference, wrong, plug, long)["largest force at P3"] == pytest.approx(1e-3, rel=1e-6)


def test_on_a_switch_either_side_is_right(plug: Plug) -> None:
    """The one sample in the last 0.1 mm is on the dead point, where the press force ends: it may act there or not."""
    reference = uncertified(scene_files.load("crank_press", {"drive.start": 90, "loads.0.last": 0.1}))
    scene, motion, forces = reference.scene, commanded(reference), reference.scene.channels.names(Role.force)
    there = np.abs(np.sin(motion["crank_angle"]) + 1) < 1e-9
    assert there.sum() == 1
    for loads in ((), (Force("slider", "B", (0.0, 1600e3)),)):  # it never acts, or always
        side = commanded(of_scene(reference, replace(scene, loads=loads)))
        either = {c: np.where(there & (c in forces), side[c], values) for c, values in motion.samples.items()}
        assert max(differences(reference, Motion(either), plug).values()) <= 1e-9


def test_an_engine_without_a_channel_lacks_its_numbers(reference: Reference, plug: Plug) -> None:
    motion = commanded(reference)
    without = {channel: values for channel, values in motion.samples.items() if channel != "P3.fx"}
    off = differences(reference, Motion(without, {"P3.fx": "it has none"}), plug)
    assert "largest force at P3" not in off
    assert "largest force at P4" in off


def test_exudyn_finds_the_same_numbers(reference: Reference) -> None:
    """As far as its channels are promised."""
    found = peaks(reference, SAMPLING, [measure(reference, "exudyn", SAMPLING)])
    own = [peak.differs["exudyn"] for peak in found if peak.unit != "rad" and "singular" not in peak.name]
    assert len(own) == 21
    assert 1e-15 < max(own) < 1e-6
