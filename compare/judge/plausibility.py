"""What a designer should know of a scene: how its file was taken, and numbers that are possible and unlikely.

Unlikely numbers are what a slip of a unit, a sign or a frame leaves. Each rule is a function that yields a sentence, in
the units of the file, for every number that it finds unlikely. None is a failure: a machine may be meant so. The bounds
are far beyond what machines have, so that few sentences are in vain. A table that helps the motion needs the
reference's motion; the others look at numbers of the scene alone.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import ceil, hypot, sqrt
from typing import TypeAlias

import numpy as np

from scenes import Failure, Sampling, Scene
from scenes.bodies import CLOSED
from scenes.elements.friction import PinFriction
from scenes.elements.loads import Load
from scenes.scene import GROUND, Body, MotionLaw

from ..mechanics.axis import cycle_name
from ..mechanics.bodies import arms, distances, weights
from ..mechanics.elements import of_element, power_of
from ..mechanics.motion_vectors import MotionVectors
from ..mechanics.reference import Reference

Rule: TypeAlias = Callable[[Reference], Iterator[str]]

GRAVITY = 0.1, 30.0  # m/s^2: of a small moon, and above that of any planet with ground to stand on
MAX_COEFFICIENT = 1.0  # of friction: rubber on a road
MAX_GYRATION = 3.0  # sizes of a body
MAX_PIN = 0.5  # of a bar's length: the radius of its pin
SIZES = 1e-5, 100.0  # m: the largest length of a machine
PERIOD_TOL = 1e-9  # of a cycle: by how much the period of a table may be longer, by rounding
STEPS = 720  # of a cycle, for the work of a table
MAX_SPLINE_EXCESS = 0.01  # of a motion law's table: its spline may leave it by so much without a word
MAX_HEIGHT_OF_BAR = 0.05  # of its longest side: a plate no higher is as likely meant to be a bar
MAX_WORK_GAINED = 0.01  # of all work, given or taken: what a table may give more than it takes


def remarks(reference: Reference, sampling: Sampling) -> Iterator[str]:
    """Yield every sentence on a scene; those on its sketch, which are known with the reference, come last."""
    scene = reference.scene
    yield from notes(scene)
    yield from point_masses(scene)
    yield from implausible(reference)
    yield from parts_of_cycles(scene, sampling)
    yield from reference.notes


def notes(scene: Scene) -> Iterator[str]:
    """Yield a sentence on a motion law that leaves its table, and on each plate or bar that is nearly the other."""
    for law in (
        drive.law for drive in scene.drives if isinstance(drive.law, MotionLaw) and drive.law.beyond > MAX_SPLINE_EXCESS
    ):
        leaves = f"drives from {scene.between(law.extent)}, beyond its table's {scene.between(law.table)}"
        closer = "more rows where the motion changes keep it closer, 'segments' or 'harmonics' have no table to leave"
        yield f"the motion law's spline {leaves}: {closer}"
    uniform = (body for body in scene.bodies.values() if body.mass and body.com is None and len(body.points) > 2)
    for body in uniform:
        height = max(body.heights)
        nearly = f"{body.name}, of points nearly on one line (a height of {100 * height:.2g} % of its longest side)"
        if len(body.corners) == 2 and height > CLOSED:
            taken = f"is taken for a uniform bar from {' to '.join(body.corners)}"
            yield f"{nearly}, {taken}; a plate has down to half the inertia: give com and inertia where it is one"
        elif len(body.corners) == 3 and height <= MAX_HEIGHT_OF_BAR:
            taken = "is taken for a uniform triangular plate; a bar has up to twice the inertia"
            yield f"{nearly}, {taken}: give com and inertia, or put the points on the line"


def point_masses(scene: Scene) -> Iterator[str]:
    """Yield a sentence on each cylinder and rod whose mass is taken to be at its one pin."""
    for name, slide in scene.slides.items():
        pair = [scene.bodies[each] for each in (name, slide.on) if each != GROUND]
        if name in scene.turning and (name in scene.driven or all(len(body.points) == 1 for body in pair)):
            for body in (body for body in pair if body.mass and body.com is None and len(body.points) == 1):
                yield f"{body.name} is taken for a point mass at {body.points[0]}, its only pin: give com and inertia"


def parts_of_cycles(scene: Scene, sampling: Sampling) -> Iterator[str]:
    """Yield a sentence on each periodic table of a load of which the cycles asked for show a part."""
    cycle = cycle_name(scene)
    for number, load in enumerate(scene.loads):
        if (turns := cycles_of(scene, load)) > sampling.turns:
            shown = f"one {cycle} shows" if sampling.turns == 1 else f"{sampling.turns} {cycle}s show"
            yield f"the table of loads.{number} has a period of {turns} {cycle}s; {shown} a part, --turns {turns} all"


def implausible(reference: Reference) -> Iterator[str]:
    """Yield a sentence on every unlikely number of a scene."""
    for unlikely in RULES:
        yield from unlikely(reference)


def gravity(reference: Reference) -> Iterator[str]:
    """Gravity of another size than that of planets, or upwards; one of zero is none."""
    x, y = reference.scene.gravity or (0.0, 0.0)
    least, most = GRAVITY
    if (size := hypot(x, y)) and not least <= size <= most:
        yield f"gravity is {size:.4g} m/s^2, and 9.81 on Earth: it is in m/s^2, whatever the other units"
    if y > 0:
        yield f"gravity points upwards, [{x:g}, {y:g}]: y is up, and [0, -9.81] downwards"


def coefficients(reference: Reference) -> Iterator[str]:
    """A coefficient of friction that no pair of machine parts has."""
    for friction in reference.scene.friction:
        if friction.coefficient > MAX_COEFFICIENT:
            joint = friction.joint(reference.scene)
            yield f"the coefficient of friction at {joint} is {friction.coefficient:g}; steel on steel has 0.1 to 0.8"


def centres_of_mass(reference: Reference) -> Iterator[str]:
    """A centre of mass that is outside the box of its body's points by more than its size."""
    scene = reference.scene
    for body in _weighed(scene):
        places = np.array([*arms(scene, body).values()])
        com, size = weights(scene, body).com, _size(body)
        x, y = (
            np.clip(coordinate, extent.min(), extent.max())
            for coordinate, extent in ((com.real, places.real), (com.imag, places.imag))
        )
        if (distance := abs(com - complex(x, y))) > size:
            apart = f"{scene.length(distance)} off its points, which are {scene.length(size)} apart at most"
            yield f"the centre of mass of {body.name} is {apart}: 'com' is in the frame of the body, as its points are"


def radii_of_gyration(reference: Reference) -> Iterator[str]:
    """An inertia that mass within a few sizes of the body cannot have."""
    scene = reference.scene
    for body in _weighed(scene):
        mass, _, inertia = weights(scene, body)
        if mass and (radius := sqrt(inertia / mass)) > MAX_GYRATION * (size := _size(body)):
            apart = f"{scene.length(radius)}, and its points are {scene.length(size)} apart at most"
            unit = scene.all_units["inertia"][0].replace("*", " ")
            yield f"the radius of gyration of {body.name} is {apart}: 'inertia' is in {unit}, about the centre of mass"


def pins(reference: Reference) -> Iterator[str]:
    """A pin's radius above half the length of one of its bars; of a crank that is driven, above all of its length."""
    scene = reference.scene
    for friction in scene.of_type(PinFriction).values():
        pin = friction.pin(scene)
        for body in (scene.bodies[name] for name in (pin.first, pin.second) if name != GROUND):
            share = MAX_PIN * (2 if body.name in scene.driven else 1)  # which may be an eccentric
            if friction.radius > share * _size(body) > 0:
                radius, size = scene.length(friction.radius), scene.length(_size(body))
                yield f"the pin at {friction.at} has a radius of {radius}, and {body.name} a length of {size}"


def sizes(reference: Reference) -> Iterator[str]:
    """A machine that is larger than a hall, or smaller than a hair is thick."""
    size, scene = reference.mechanics.size, reference.scene
    least, most = SIZES
    if not least <= size <= most:
        metres = "" if scene.units["length"][0] == "m" else f", {size:.4g} m"
        yield f"the largest length is {scene.length(size)}{metres}: lengths are in 'units.length', m where it is absent"


def helping_tables(reference: Reference) -> Iterator[str]:
    """A table over the drive or the time on the output's body that gives more work than it takes.

    Its power is that of the reference's motion, by trapezoids over as many cycles as its period has.
    """
    scene = reference.scene
    for number, load in enumerate(scene.loads):
        if load.table is None or load.table.over == "displacement" or load.body not in scene.owners[scene.output]:
            continue
        asked = Sampling(STEPS, cycles_of(scene, load))
        try:
            motion = reference.at(asked.inputs(scene))
        except Failure:
            continue
        state = MotionVectors(scene, motion)
        power = sum(power_of(state, push) for push in of_element(state, load))
        # Work with and against the motion apart: a resistance takes what it gives back at most.
        given, taken = (float(np.trapezoid(np.maximum(sign * power, 0.0), motion["time"])) for sign in (1, -1))
        if given - taken > MAX_WORK_GAINED * (given + taken):
            share = (
                f"{given / taken:.3g} times the work that it takes"
                if taken > MAX_WORK_GAINED * given
                else "work and takes none"
            )
            helps = "it helps the motion, as the gas of an engine does and no resistance"
            yield f"the table of loads.{number} gives {load.body} {share}: {helps}"


RULES: Sequence[Rule] = (gravity, coefficients, centres_of_mass, radii_of_gyration, pins, sizes, helping_tables)


def cycles_of(scene: Scene, load: Load) -> int:
    """How many cycles of the drive the period of a load's table has; one of others."""
    law, table = scene.drives[0].law, load.table  # by the first of which tables go
    lengths: Mapping[str, float] = {"drive": abs(float(law.after(1.0) - law.after(0.0))), "time": scene.cycle}
    if table is None or not (table.periodic and scene.periodic and lengths.get(table.over)):
        return 1
    return ceil(float(table.arguments[-1] - table.arguments[0]) / lengths[table.over] - PERIOD_TOL)


def _weighed(scene: Scene) -> Iterator[Body]:
    """The bodies that have a mass, and by their points a size: more than one, and no guide, which may be far longer."""
    guides = {body for name, slide in scene.slides.items() for body in (name, slide.on)}
    return (b for b in scene.bodies.values() if b.mass is not None and b.name not in guides and _size(b) > 0)


def _size(body: Body) -> float:
    """The largest known distance of a body's points, m; zero of one point."""
    return max(distances(body).values(), default=0.0)
