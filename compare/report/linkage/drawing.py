"""How a motion is drawn: where metres and newtons are in the picture."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import floor, log10

import numpy as np

from scenes import Motion, Scene
from scenes.model.motion import Samples
from scenes.scene import Body

from ...mechanics.axis import prefixed
from ...mechanics.motion_vectors import MotionVectors, Vectors
from .arrows import Arrow, arrows

SIZE = 1000.0  # of the picture's longer side, in its own units
PX = SIZE / 480  # a pixel, in those units: what signs that do not scale are drawn in until a script knows better
MARGIN, WIDER = 32 * PX, 46 * PX  # for signs and names around the outermost points; with the values of forces
FOOT = 20 * PX  # for the scale of the forces
SHARE = 0.2  # of the longer side: the longest arrow, but for peaks that few samples have


@dataclass(frozen=True)
class Drawing:
    """How a motion is drawn: where metres and newtons are in the picture."""

    scene: Scene
    motion: Motion
    others: Sequence["Drawing"] = ()  # at the scale of which, in a box around all, it is drawn

    @cached_property
    def state(self) -> MotionVectors:
        """The motion's vectors."""
        return MotionVectors(self.scene, self.motion)

    @cached_property
    def places(self) -> dict[str, Vectors]:
        """Where every point is, m, shape (n,)."""
        return {point: self.state.place(point) for point in self.scene.owners}

    @cached_property
    def arrows(self) -> list[Arrow]:
        """Every force of the motion."""
        return arrows(self.scene, self.motion, self.motion)

    @cached_property
    def peak(self) -> float:
        """The largest force, N, but for those of a fiftieth of the samples, which a singular configuration may have."""
        sizes = [np.abs(arrow.force) for drawing in (self, *self.others) for arrow in drawing.arrows]
        usual = max((float(np.sort(size)[-1 - len(size) // 50]) for size in sizes), default=0.0)
        return usual or max((float(size.max()) for size in sizes), default=0.0)

    @cached_property
    def scale(self) -> tuple[float, float]:
        """A round force, N, and how long its arrow is, in the file's unit of length; zeros where there is no force."""
        if not self.peak > 0:
            return 0.0, 0.0
        places = np.concatenate([way for drawing in (self, *self.others) for way in drawing.places.values()])
        power = 10.0 ** floor(log10(self.peak))
        force = next(share * power for share in (5, 2, 1) if share * power <= self.peak)
        longest = SHARE * max(np.ptp(places.real), np.ptp(places.imag))
        return force, float(f"{force / self.peak * longest / self.scene.length_unit[1]:.2g}")

    @property
    def per_newton(self) -> float:
        """How long an arrow is, m a newton."""
        force, length = self.scale
        return length * self.scene.length_unit[1] / force if force else 0.0

    @property
    def scale_text(self) -> str:
        """The arrows' scale in words: `100 kN = 38 mm`; nothing where there is no force."""
        force, length = self.scale
        factor, newtons = prefixed(self.peak, "N")
        return f"{factor * force:g} {newtons} = {length:g} {self.scene.length_unit[0]}" if force else ""

    @cached_property
    def box(self) -> tuple[complex, complex]:
        """The corners of what is drawn, m: points, slots, sketch and arrows, but for the tips of the longest peaks."""
        shown = [part for drawing in (self, *self.others) for part in drawing._shown(self.per_newton, self.peak)]
        every = np.concatenate(shown)
        return complex(every.real.min(), every.imag.min()), complex(every.real.max(), every.imag.max())

    def _shown(self, per_newton: float, peak: float) -> Iterator[Vectors]:
        yield from self.places.values()
        yield np.array([complex(*place) for place in self.scene.sketch.points.values()], np.complex128)
        for body in self.scene.bodies.values():
            if body.slide is not None:
                origin, x_axis = self.state.frame(body.slide.on)
                yield from (origin + x_axis * end for end in self.way(body))
        for arrow in self.arrows:
            size = np.maximum(np.abs(arrow.force), peak or 1.0)
            way = arrow.force * (per_newton * peak / size).astype(np.complex128)
            yield self.places[arrow.point] - way if arrow.load else self.places[arrow.point] + way

    @property
    def margin(self) -> float:
        """What is left free around the box, in the picture's units."""
        return WIDER if self.arrows else MARGIN

    @cached_property
    def per_metre(self) -> float:
        """The picture's units a metre."""
        across = self.box[1] - self.box[0]
        return (SIZE - 2 * self.margin) / max(across.real, across.imag)

    @cached_property
    def size(self) -> tuple[float, float]:
        """Width and height of the picture, in its units."""
        across = self.per_metre * (self.box[1] - self.box[0])
        foot = FOOT if self.scale_text else 0.0
        return across.real + 2 * self.margin, across.imag + 2 * self.margin + foot

    @cached_property
    def corner(self) -> complex:
        """The picture's upper left corner, m."""
        margin = self.margin / self.per_metre
        return complex(self.box[0].real - margin, self.box[1].imag + margin)

    def units(self, places: Vectors) -> Vectors:
        """Places, m, in the picture's units, x to the right and i times y downwards."""
        shown: Vectors = self.per_metre * (places - self.corner).conj()
        return shown

    def frame(self, body: Body) -> Samples:
        """The angle of a body in the picture, shape (n,), degrees clockwise, without jumps."""
        return -np.degrees(np.unwrap(self.state.angle(body.name)))

    def own(self, body: Body) -> dict[str, complex]:
        """A body's points in its own frame from the first, in the picture's units."""
        first = self.places[body.points[0]][0]
        turn = self.per_metre * np.exp(1j * self.state.angle(body.name)[0])
        return {point: complex(turn * (self.places[point][0] - first).conjugate()) for point in body.points}

    def way(self, slider: Body) -> tuple[complex, complex]:
        """Both ends of a slider's way in the frame of its carrier, or of the ground, m."""
        assert slider.slide is not None
        way = self.state.on_guide(slider).real
        first, last = (
            complex(*slider.slide.through) + end * complex(*slider.slide.along) for end in (way.min(), way.max())
        )
        return first, last
