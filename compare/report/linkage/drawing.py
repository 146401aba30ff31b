"""How a motion is drawn: the forces that its picture shows, and where metres and newtons are in it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import floor, log10

import numpy as np

from scenes import Motion, Scene
from scenes.scene import Body, PinFriction

from ...mechanics.elements import force
from ...mechanics.motion_vectors import MotionVectors, Vectors
from ...mechanics.quantities import Units, suited

SIZE = 1000.0  # of the picture's longer side, in its own units
PX = SIZE / 480  # a pixel, in those units: what signs that do not scale are drawn in until a script knows better
MARGIN, WIDER = 32 * PX, 46 * PX  # for signs and names around the outermost points; with the values of forces
FOOT = 20 * PX  # for the scale of the forces
CIRCLE = 12 * PX  # radius of the largest friction circle, at least; those of a press would be smaller than its pins
LARGER = [n * 10**power for power in range(4) for n in (1, 2, 5)]  # circles are drawn so many times as large
BARREL = 0.85  # of the least displacement of its rod: how long a cylinder is drawn
MAX_ARROW = 0.2  # of the longer side, but for peaks that few samples have


@dataclass(frozen=True)
class Arrow:
    """One force over a motion."""

    name: str
    point: str  # where it attacks
    force: Vectors  # N, shape (n,)
    components: Sequence[str]  # their names: of a pin, its channels; of a guide one channel, which acts along `way`
    load: bool = False  # rather than of a joint
    on: str = ""  # what carries the guide
    way: tuple[float, float] = (0.0, 0.0)  # in the frame of that, of length 1
    moment: str = ""  # of the pin's friction, its channel, where it has one
    aside: Vectors | float = 0.0  # m, from the pin to the force's line, by that moment


def arrows(scene: Scene, pose: Motion, motion: Motion) -> Iterator[Arrow]:
    """Yield the forces of pins, guides and a driven slider's drive that a motion has, and loads; none without masses.

    How guides are turned, and where loads act, is by the pose, which has all channels at the samples of the motion.
    """
    if not scene.has_masses:
        return
    state = MotionVectors(scene, pose)
    rubbing = {friction.channel(scene) for friction in scene.friction}
    for pin in scene.pins:
        components, moment = scene.channels.pins.get(pin.channel, ("", "")), f"{pin.channel}.friction_moment"
        if all(component in motion for component in components):
            R = motion[components[0]] + 1j * motion[components[1]]
            line: tuple[str, Vectors | float] = ("", 0.0)
            if moment in rubbing and moment in motion:
                # A force R at the pin and the moment M of friction about it are one force R on a parallel line. The
                # offset a of that line is at a right angle to R and has a x R = M: with complex numbers a = -i M /
                # conj(R). The line touches the friction circle, which is how the picture shows it.
                line = moment, -1j * motion[moment] / np.where(R == 0, 1.0, R.conj())
            name = f"{pin.channel}: {pin.first} on {pin.second}"
            yield Arrow(name, pin.point, R, components, moment=line[0], aside=line[1])
    for slider, slide in scene.slides.items():
        body, (x, y) = scene.bodies[slider], slide.along
        acting = [(f"guide on {slider}", f"{slider}.guide_force", 1j, (-y, x))]
        acting += [(f"drive on {slider}", "drive.force", 1.0, (x, y))] * (slider in scene.driven)
        for name, channel, turn, way in acting:
            if channel in motion:
                along = motion[channel] * (turn * state.along(body))
                yield Arrow(name, body.points[0], along, (channel,), on=slide.on, way=way)
    state = state.pressed(state.stroke_ends())
    for body in scene.bodies.values():
        for number, load in enumerate(scene.loads):
            if load.body != body.name or load.is_moment:
                continue
            components = f"loads.{number} x", f"loads.{number} y"
            yield Arrow(f"load on {body.name}", load.at, force(state, load), components, load=True)


class Drawing:
    """A motion as it is drawn: where metres and newtons are in the picture, at one scale and in one box with others."""

    def __init__(
        self, scene: Scene, motion: Motion, others: Sequence["Drawing"] = (), named: Units | None = None
    ) -> None:
        self.scene, self.motion, self.state = scene, motion, MotionVectors(scene, motion)
        self.places = {point: self.state.place(point) for point in scene.owners}  # m, shape (n,)
        self.arrows = [*arrows(scene, motion, motion)]
        every = [self, *others]
        sizes = [np.sort(np.abs(arrow.force)) for drawing in every for arrow in drawing.arrows]
        # Arrows are scaled by the size that 98 % of the samples stay below, not by the peak: near a singular pose
        # forces grow without bound, and by the peak all other arrows would be dots. Longer arrows leave the picture.
        usual = max((float(size[-1 - len(size) // 50]) for size in sizes), default=0.0)  # a singular pose has larger
        peak = usual or max((float(size[-1]) for size in sizes), default=0.0)
        self.per_newton, self.scale_text = _scale(peak, every, named or suited(scene.units, [("N", peak)]))
        shown = np.concatenate([part for drawing in every for part in drawing._shown(self.per_newton, peak)])
        self.box = complex(shown.real.min(), shown.imag.min()), complex(shown.real.max(), shown.imag.max())
        across, margin = self.box[1] - self.box[0], WIDER if self.arrows else MARGIN
        self.per_metre = (SIZE - 2 * margin) / max(across.real, across.imag)
        arms = {friction: friction.arm for friction in scene.of_type(PinFriction).values() if self.arrows}
        self.circles = [
            (friction.at, self.per_metre * arm) for friction, arm in arms.items()
        ]  # of friction: the pin, the radius
        largest = max((radius for _, radius in self.circles), default=0.0)
        # Friction circles to scale are often smaller than the sign of a pin. All are magnified by one round factor, so
        # that they compare with each other.
        self.larger = next((n for n in LARGER if n * largest >= CIRCLE), LARGER[-1]) if largest else 1
        foot, free = FOOT * (bool(self.scale_text) + bool(self.circles)), margin / self.per_metre
        self.size = self.per_metre * across.real + 2 * margin, self.per_metre * across.imag + 2 * margin + foot
        self.corner = complex(self.box[0].real - free, self.box[1].imag + free)  # the upper left one, m

    def _shown(self, per_newton: float, peak: float) -> Iterator[Vectors]:
        """Yield points, slots, sketch and arrows, but for the tips of the longest peaks."""
        yield from self.places.values()
        yield np.array([complex(*place) for place in self.scene.sketch.points.values()], np.complex128)
        for name, slide in self.scene.slides.items():
            origin, x_axis = self.state.frame(slide.on)
            yield from (origin + x_axis * end for end in self.way(name))
        for arrow in self.arrows:
            size = np.maximum(np.abs(arrow.force), peak or 1.0)
            way = arrow.force * (per_newton * peak / size).astype(np.complex128)
            yield self.places[arrow.point] - way if arrow.load else self.places[arrow.point] + way

    def units(self, places: Vectors) -> Vectors:
        """Places, m, in the picture's units, x to the right and i times y downwards."""
        return np.asarray(self.per_metre * (places - self.corner).conj())

    def drawn(self, arrow: Arrow) -> Vectors:
        """A force from where it attacks, in the picture's units."""
        return np.asarray(self.per_metre * self.per_newton * arrow.force.conj())

    def own(self, body: Body) -> dict[str, complex]:
        """A body's points in its own frame from the first, in the picture's units."""
        first = self.places[body.points[0]][0]
        turn = self.per_metre * np.exp(1j * self.state.angle(body.name)[0])
        return {point: complex(turn * (self.places[point][0] - first).conjugate()) for point in body.points}

    def way(self, name: str) -> Vectors:
        """Both ends of a slider's way in the frame of its carrier, or of the ground, m; of a rod its cylinder."""
        slide, along = self.scene.slides[name], self.state.on_guide(self.scene.bodies[name]).real
        ends = np.array([0.0, BARREL * along.min()] if self.rod(name) else [along.min(), along.max()])
        return complex(*slide.through) + ends * complex(*slide.along)

    def rod(self, name: str) -> float:
        """How far a rod goes into its cylinder, each with one pin, m; of other sliders nothing."""
        slider, carrier = self.scene.bodies[name], self.scene.bodies.get(self.scene.slides[name].on)
        if carrier is None or len(carrier.points) > 1 or len(slider.points) > 1:
            return 0.0
        along = self.state.on_guide(slider).real
        return float(np.clip(along.max() - along.min() / 2, 0.0, max(along.min(), 0.0)))


def foot(places: Vectors, start: Vectors, end: Vectors) -> Vectors:
    """The nearest place on a line from start to end, to each of some places."""
    way = end - start
    share = np.clip(((places - start) * way.conj()).real / np.maximum(np.abs(way) ** 2, 1e-12), 0, 1)
    return np.asarray(start + share * way)


def _scale(peak: float, drawings: Sequence[Drawing], named: Units) -> tuple[float, str]:
    """How long an arrow is, m a newton, and for which round force: `100 kN = 38 mm`; nothing without a force."""
    if not peak > 0:
        return 0.0, ""
    places = np.concatenate([way for drawing in drawings for way in drawing.places.values()])
    (per_newton, newtons), (per_metre, metres) = named["N"], named["m"]
    # The legend's force is the largest of 1, 2 or 5 times a power of ten that is not above the peak. Its length on
    # paper is rounded to two digits, and arrows follow that rounded length, so that the legend is exact.
    power = 10.0 ** floor(log10(per_newton * peak))
    force = next(share * power for share in (5, 2, 1) if share * power <= per_newton * peak)
    longest = MAX_ARROW * max(np.ptp(places.real), np.ptp(places.imag))
    length = float(f"{force / (per_newton * peak) * longest * per_metre:.2g}")
    return length / per_metre * per_newton / force, f"{force:g} {newtons} = {length:g} {metres}"
