"""Faults in what the motion and the loads need: terms left out everywhere, loads that are late or on the neighbour."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from compare.engines import registry
from compare.judge.canaries import spoilt_motion as spoilt
from compare.judge.causes.cause import Kind
from compare.mechanics import elements
from compare.mechanics.bodies import inertia
from compare.mechanics.motion_vectors import MotionVectors, Vectors
from scenes import Motion
from scenes.channels import Role
from scenes.scene import GROUND, Force, GuideForce, Moment

from .fault import Clean, Fault


def left_out(clean: Clean) -> Iterator[Fault]:
    """Yield a crank without mass, inertia left out everywhere, loads that are late or act on the neighbouring body."""
    scene, state = clean.scene, clean.state
    turning = [name for name in scene.turning if scene.bodies[name].mass and len(scene.bodies[name].points) > 1]
    crank = scene.drive.body
    if scene.bodies[crank].mass:
        light = replace(scene.bodies[crank].weighed, mass=0.0, inertia=0.0, com=scene.bodies[crank].com or (0.0, 0.0))
        spoilt_scene = replace(scene, bodies={**scene.bodies, crank: light})
        yield Fault("crank without mass", "the driven body without mass", 1, Kind.mass, crank, scene=spoilt_scene)
    off = swung = clean.motion
    for name in turning:
        body, (_, omega, alpha) = scene.bodies[name], state.turning(name)
        first, other = body.points[:2]
        r, d = state.com(body)[0] - state.place(first), state.place(other) - state.place(first)
        off = _pushed(clean, off, name, first, -(body.mass or 0.0) * omega**2 * r)
        couple = 1j * d / np.abs(d) ** 2 * inertia(body) * alpha
        swung = _pushed(clean, _pushed(clean, swung, name, other, couple), name, first, -couple)
    if turning:
        yield Fault("m s w^2", "m s w^2 left out everywhere", 1, Kind.term, "all", lambda: off)
        yield Fault("I alpha", "I alpha left out everywhere", 1, Kind.inertia, "all", lambda: swung)
    rows, presses = np.arange(clean.sampling.count), scene.presses.values()
    for load in scene.loads:
        if isinstance(load, Moment) or (isinstance(load, GuideForce) and load.kind != "force tables"):
            continue
        acting = [acts[0] for one, acts in zip(presses, clean.reference.acts(clean.true), strict=True) if one is load]
        own = elements.force(MotionVectors(replace(scene, loads=(load,)), clean.true, acting), load)
        for by in (1, 2) if not isinstance(load, Force) else ():
            change = partial(_pushed, clean, clean.motion, load.body, load.at, own[np.maximum(rows - by, 0)] - own)
            yield Fault("late load", "a load switched late", by, Kind.load, load.at, change)
        for owner in [one for one in scene.owners[load.at] if one not in (load.body, GROUND)][:1]:
            less = _pushed(clean, clean.motion, load.body, load.at, -own)
            change = partial(_pushed, clean, less, owner, load.at, own)
            yield Fault("load on the neighbour", "a load on the neighbouring body", 1, Kind.load, load.at, change)


def _pushed(clean: Clean, motion: Motion, body: str, point: str, force: Vectors) -> Motion:
    """Return a motion whose reactions carry a further force: what they have of a constant one, as that is linear."""
    size = float(np.abs(force).max()) or 1.0
    for along, share in (((size, 0.0), force.real / size), ((0.0, size), force.imag / size)):
        loaded = replace(clean.scene, loads=(*clean.scene.loads, Force(body, point, along)))
        there = registry.reference(loaded)(clean.true.inputs(loaded))
        more = {c: motion[c] + share * (there[c] - clean.true[c]) for c in clean.scene.channels.names(Role.force)}
        motion = spoilt.replaced(motion, more)
    return motion
