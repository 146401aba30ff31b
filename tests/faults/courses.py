"""Faults in the course of a motion: in ten rows alone, growing, from the start on, over the turn, in coarse samples."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from compare.engines import registry
from compare.judge.canaries import spoilt_motion as spoilt
from compare.judge.causes.cause import Kind
from scenes import Failure, Motion
from scenes.fields import put
from scenes.model.motion import Samples

from .fault import Clean, Fault
from .read_out import signs, vectors_in_other_frames

TEN = 10  # rows


def courses(clean: Clean) -> Iterator[Fault]:
    """Yield motions that are wrong in a part of their rows, or ever more or less so."""
    yield from _in_ten_rows(clean)
    yield from _half_turns(clean)
    yield from _drifts(clean)
    yield from _starts(clean)
    yield from _breathing(clean)
    yield from _from_coarse_samples(clean)


def _in_rows(clean: Clean, spoil: Callable[[], Motion], rows: slice) -> Motion:
    """Return a motion that is wrong in some rows, and right in all others."""
    motion, wrong = {name: samples.copy() for name, samples in clean.motion.samples.items()}, spoil()
    for name, samples in motion.items():
        samples[rows] = wrong[name][rows]
    return Motion(motion, clean.motion.unsupported)


def _in_ten_rows(clean: Clean) -> Iterator[Fault]:
    rows = slice(clean.sampling.count // 4, clean.sampling.count // 4 + TEN)
    for fault in [*signs(clean), *vectors_in_other_frames(clean)][::3]:
        assert fault.spoil is not None
        yield replace(fault, family="ten rows", spoil=partial(_in_rows, clean, fault.spoil, rows))


def _half_turns(clean: Clean) -> Iterator[Fault]:
    middle = clean.sampling.count // 2
    for kind, rows in {"from the middle on": slice(middle, None), "in ten rows": slice(middle, middle + TEN)}.items():
        for body in clean.some(clean.scene.turning, f"half a turn {kind}"):
            turned = partial(spoilt.shifted, clean.motion, {f"{body}.angle": np.pi})
            yield Fault("half a turn", kind, np.pi, Kind.offset, body, partial(_in_rows, clean, turned, rows))


def _drifts(clean: Clean) -> Iterator[Fault]:
    run = np.linspace(0, 1, clean.sampling.count)

    def fault(kind: str, by: float, place: str, samples: Mapping[str, Samples]) -> Fault:
        change = partial(spoilt.replaced, clean.motion, samples)
        return Fault("drifting velocities", kind, by, Kind.solver, place, change)

    names = clean.of("vx", "vy", "omega")
    for by in (0.1, 5 * clean.promise):
        away = {c: clean.motion[c] + by * clean.reference.scale[c] * run for c in names}
        yield fault("all drift away", by, "all", away)
        grown = {c: clean.motion[c] * (1 + by * run) for c in names}
        yield fault("all grow", by, "all", grown)
        for stem in clean.some(clean.stems("vx"), f"a velocity grows {by}"):
            yield fault("one grows", by, stem, {c: grown[c] for c in (f"{stem}.vx", f"{stem}.vy")})


def _starts(clean: Clean) -> Iterator[Fault]:
    rows = np.arange(clean.sampling.count)
    for kind, course in {"dying": np.exp(-rows / 4), "ringing": np.exp(-rows / 6) * np.cos(rows)}.items():
        for by, groups in product((0.3, 10 * clean.promise), (("acceleration",), ("acceleration", "reaction"))):
            names = [name for _, own in clean.grouped(*groups) for name in own]
            off = {c: clean.motion[c] + by * clean.size(c).max() * course for c in names}
            change = partial(spoilt.replaced, clean.motion, off)
            yield Fault("start", f"a {kind} start: {' and '.join(groups)}", by, Kind.start, "all", change)


def _breathing(clean: Clean) -> Iterator[Fault]:
    scene, time = clean.scene, clean.true["time"]
    bars = [(name, pair) for name, body in scene.bodies.items() for pair in body.lengths or ()]
    for by in (0.01, 5 * clean.promise):
        for name, pair in clean.some(bars, f"breathing {by}"):
            longer = put(
                scene, {("bodies", name, "lengths", pair): (1 + by) * (scene.bodies[name].lengths or {})[pair]}
            )
            try:
                wrong = registry.reference(longer)(clean.true.inputs(longer))
            except Failure:
                continue
            breath = np.sin(2 * np.pi * time / scene.cycle)
            off = {c: clean.motion[c] + breath * (wrong[c] - clean.true[c]) for c in clean.channels}
            change = partial(spoilt.replaced, clean.motion, off)
            yield Fault("breathing bar", "a length varies over the turn", by, Kind.length, name, change)


def _from_coarse_samples(clean: Clean) -> Iterator[Fault]:
    rows = np.arange(clean.sampling.count)
    for every, quantities in product((2, 4, 8), (("ax", "ay", "alpha"), ("vx", "vy", "omega", "ax", "ay", "alpha"))):
        own = {c: clean.motion[c][::every] for c in clean.of(*quantities)}
        lines = {c: np.interp(rows, rows[::every], samples) for c, samples in own.items()}
        change = partial(spoilt.replaced, clean.motion, lines)
        yield Fault("coarse samples", f"lines: {', '.join(quantities)}", every, Kind.coarse, "all", change)
