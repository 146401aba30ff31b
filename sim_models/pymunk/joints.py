"""Joints and drives as constraints C(q) = 0 between the coordinates of pymunk's bodies: for each type all of a scene.

A row is the value of a joint and its gradient by the coordinates; `z` and `turn` are those of `planes`, the ground's
among them as the last.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from scenes.bodies import GROUND
from scenes.drive import Drive
from scenes.joints import DriveJoint, Guide, Joint, Pin, SlidingDrive, TurningDrive
from scenes.model.motion import Samples

from .planes import ComplexArray, PoseArray, pair, planes, point_gradients

if TYPE_CHECKING:  # which kinds there are rules for is asked without pymunk too
    import pymunk

    from .constraints import LinkageConstraints

JOINT, PARALLEL, DRIVE = range(3)  # stages: solved after all others, a drive does not lag


class InSpace(NamedTuple):
    """A joint of pymunk's; a sweep solves the first stage first."""

    joint: pymunk.Constraint
    stage: int = JOINT
    channel: str = ""  # by whose force it is known, a pin's without `.fx`


class PymunkJoints(ABC):
    """All joints of one type in a linkage."""

    @abstractmethod
    def __init__(self, linkage: LinkageConstraints, joints: Sequence[Any]) -> None:
        """Take what the bodies' numbers say of them."""

    @abstractmethod
    def values(self, q: PoseArray) -> Samples:
        """C(q) for drives at zero, shape (n, joints, equations), m and rad, of poses with the ground."""

    @abstractmethod
    def gradients(self, q: PoseArray) -> Samples:
        """dC/dq, shape (n, joints, equations, bodies, 3), of poses with the ground."""

    @staticmethod
    @abstractmethod
    def in_space(joint: Any, linkage: LinkageConstraints, bodies: Mapping[str, pymunk.Body]) -> Iterator[InSpace]:
        """Yield what holds one of them in pymunk's space; nothing where kinematic bodies do."""

    @staticmethod
    def swept(joint: Any, linkage: LinkageConstraints, rows: Samples) -> Iterator[tuple[int, Samples]]:  # noqa: ARG004
        """Yield the stage and the rows that a sweep solves at once, of those of one, shape (equations, coordinates)."""
        yield JOINT, rows


class PymunkPins(PymunkJoints):
    """Pins: x and y of second - first."""

    def __init__(self, linkage: LinkageConstraints, joints: Sequence[Pin]) -> None:
        ends = [(body, pin.point) for pin in joints for body in pin.between]
        self._bodies = np.array([linkage.index[body] for body, _ in ends], np.intp).reshape(-1, 2)
        self._arms = np.array([linkage.arm(*end) for end in ends], np.complex128).reshape(-1, 2)

    def values(self, q: PoseArray) -> Samples:
        """The gaps."""
        z, turn = planes(q)
        ends = z[:, self._bodies] + self._arms * turn[:, self._bodies]
        gaps = ends[..., 1] - ends[..., 0]
        return np.stack([gaps.real, gaps.imag], axis=-1)

    def gradients(self, q: PoseArray) -> Samples:
        """By both bodies of each."""
        n, bodies, _ = q.shape
        number = np.arange(len(self._bodies))
        gradients = point_gradients(self._arms * planes(q)[1][:, self._bodies])
        gaps = np.zeros((n, len(number), bodies, 3), dtype=np.complex128)
        gaps[:, number, self._bodies[:, 0]] -= gradients[:, :, 0]
        gaps[:, number, self._bodies[:, 1]] += gradients[:, :, 1]
        return np.stack([gaps.real, gaps.imag], axis=2)

    @staticmethod
    def in_space(joint: Pin, linkage: LinkageConstraints, bodies: Mapping[str, pymunk.Body]) -> Iterator[InSpace]:
        """A pivot; a kinematic crank needs none on the ground."""
        import pymunk

        first, second = (bodies[body] for body in joint.between)
        if pymunk.Body.DYNAMIC in (first.body_type, second.body_type):
            arms = (pair(linkage.arm(name, joint.point)) for name in joint.between)
            yield InSpace(pymunk.PivotJoint(first, second, *arms), channel=joint.channel)


class PymunkGuides(PymunkJoints):
    """Guides: the slider's way off the line, and its angle from it."""

    def __init__(self, linkage: LinkageConstraints, joints: Sequence[Guide]) -> None:
        sliders = [joint.slider for joint in joints]
        self.sliders = np.array([linkage.index[name] for name in sliders], np.intp)
        self.carriers = np.array([linkage.index[joint.slide.on] for joint in joints], np.intp)
        self.arms = np.array([linkage.first_arm(name) for name in sliders], np.complex128)
        self.through = np.array([linkage.through(name) for name in sliders], np.complex128)
        self.along = np.array([complex(*joint.slide.along) for joint in joints], np.complex128)

    def values(self, q: PoseArray) -> Samples:
        """The offsets and angles."""
        z, turn = planes(q)
        from_carrier = z[:, self.sliders] + self.arms * turn[:, self.sliders] - z[:, self.carriers]
        # With complex numbers Im(conj(u) d) is the part of d across a unit vector u. Here u turns with the carrier, and
        # d leads from its centre of mass to the slider's first point.
        offset = (np.conj(self.along * turn[:, self.carriers]) * from_carrier - np.conj(self.along) * self.through).imag
        return np.stack([offset, q[:, self.sliders, 2] - q[:, self.carriers, 2]], axis=-1)

    def gradients(self, q: PoseArray) -> Samples:
        """By the slider and what has the guide."""
        n, bodies, _ = q.shape
        number = np.arange(len(self.sliders))
        gradients = np.zeros((n, len(number), 2, bodies, 3))
        gradients[:, :, 0] = self.slid(q).imag
        gradients[:, number, 1, self.sliders, 2] = 1
        gradients[:, number, 1, self.carriers, 2] = -1
        return gradients

    @staticmethod
    def swept(joint: Guide, linkage: LinkageConstraints, rows: Samples) -> Iterator[tuple[int, Samples]]:
        """The offset where the groove is met, and the angle that a gear keeps zero."""
        offset, angle = rows
        # pymunk meets the groove at the foot of the perpendicular from the slider's centre of mass, where turning the
        # slider does not change the offset: its share of the row, a multiple of the angle's row, is taken off.
        yield JOINT, (offset - offset[3 * linkage.index[joint.slider] + 2] * angle)[None]
        if joint.slider in linkage.scene.turning:
            yield PARALLEL, angle[None]

    def slid(self, q: PoseArray) -> ComplexArray:
        """The gradients of displacements plus i offsets, shape (n, sliders, bodies, 3)."""
        z, turn = planes(q)
        number, arms = np.arange(len(self.sliders)), self.arms * turn[:, self.sliders]
        from_carrier = z[:, self.sliders] + arms - z[:, self.carriers]
        # w = conj(u) d has the displacement as its real and the offset as its imaginary part. A turn of the carrier by
        # dθ turns u as well, by which w changes by -i conj(u) d dθ: as if the whole way d turned back.
        along = np.conj(self.along * turn[:, self.carriers])[..., None]
        gradients = np.zeros((len(q), len(number), *q.shape[1:]), np.complex128)
        gradients[:, number, self.sliders] = along * point_gradients(arms)
        gradients[:, number, self.carriers] = -along * point_gradients(from_carrier)
        return gradients

    @staticmethod
    def in_space(joint: Guide, linkage: LinkageConstraints, bodies: Mapping[str, pymunk.Body]) -> Iterator[InSpace]:
        """A groove, and a gear that keeps the slider parallel where it can turn; a driven slider needs none.

        The engine projects its 2 x 2 solution on the groove's normal, which is exact only if that is an axis of its
        mass matrix: the groove runs through the carrier's centre of mass, and is met at the foot of the perpendicular
        from the slider's. As both stay parallel, it may be any groove parallel to the true one.
        """
        import pymunk

        # No two bodies get further apart than all of them in a row; the ends of a groove would be stops.
        reach = 2 * (len(linkage.members) + 1) * linkage.size
        name, (carrier, slider) = joint.slider, (bodies[body] for body in joint.between)
        if slider.body_type == pymunk.Body.DYNAMIC:
            along = complex(*joint.slide.along)
            foot = 1j * along * (along.conjugate() * (linkage.first_arm(name) - linkage.through(name))).imag
            places = (pair(place) for place in (-reach * along, reach * along, foot))
            yield InSpace(pymunk.GrooveJoint(carrier, slider, *places), channel=f"{name}.guide_force")
        if name in linkage.scene.turning:
            yield InSpace(pymunk.GearJoint(carrier, slider, 0, 1), PARALLEL)


class PymunkDrives(PymunkJoints):
    """Drives."""

    @staticmethod
    def swept(joint: DriveJoint, linkage: LinkageConstraints, rows: Samples) -> Iterator[tuple[int, Samples]]:  # noqa: ARG004
        """Its row, last."""
        yield DRIVE, rows


class PymunkTurningDrives(PymunkDrives):
    """Drives of an angle: that of the body from the other."""

    def __init__(self, linkage: LinkageConstraints, joints: Sequence[TurningDrive]) -> None:
        self._bodies = np.array([[linkage.index[body] for body in joint.between] for joint in joints], np.intp)

    def values(self, q: PoseArray) -> Samples:
        """The angles."""
        return (q[:, self._bodies[:, 1], 2] - q[:, self._bodies[:, 0], 2])[..., None]

    def gradients(self, q: PoseArray) -> Samples:
        """By both angles."""
        number = np.arange(len(self._bodies))
        gradients = np.zeros((len(q), len(number), 1, *q.shape[1:]))
        gradients[:, number, 0, self._bodies[:, 0], 2] = -1
        gradients[:, number, 0, self._bodies[:, 1], 2] = 1
        return gradients

    @staticmethod
    def in_space(joint: TurningDrive, _: LinkageConstraints, bodies: Mapping[str, pymunk.Body]) -> Iterator[InSpace]:
        """A gear between moving bodies."""
        import pymunk

        if joint.drive.on != GROUND:
            on, body = (bodies[name] for name in joint.between)
            yield InSpace(pymunk.GearJoint(on, body, 0, 1), DRIVE)


class PymunkSlidingDrives(PymunkDrives):
    """Drives along a guide: on the ground the displacement, on a body the length of the bar that stands for it."""

    def __init__(self, linkage: LinkageConstraints, joints: Sequence[SlidingDrive]) -> None:
        self._linkage, self._drives = linkage, [joint.drive for joint in joints]
        self._guides = PymunkGuides(linkage, [Guide(drive.body, linkage.slides[drive.body]) for drive in self._drives])

    def values(self, q: PoseArray) -> Samples:
        """The positions."""
        z, turn = planes(q)
        positions = [
            self._linkage.displacement(drive.body, z.T, turn.T)
            if drive.on == GROUND
            else self._linkage.back + np.abs(self._bar(drive, q))
            for drive in self._drives
        ]
        return np.stack(positions, axis=1)[..., None]

    def gradients(self, q: PoseArray) -> Samples:
        """By the body, and what it is driven on."""
        linkage, (_, turn) = self._linkage, planes(q)
        gradients = self._guides.slid(q).real[:, :, None]
        for number, drive in enumerate(self._drives):
            if drive.on == GROUND:
                continue
            bar, (body, on) = self._bar(drive, q), (linkage.index[name] for name in (drive.body, drive.on))
            # The gradient of a length |b| is Re(conj(b / |b|) db).
            back = np.conj(bar / np.abs(bar))[:, None]
            first, end = linkage.first_arm(drive.body), linkage.back_end
            gradients[:, number] = 0
            gradients[:, number, 0, body] = (back * point_gradients(first * turn[:, body])).real
            gradients[:, number, 0, on] = -(back * point_gradients(end * turn[:, on])).real
        return gradients

    @staticmethod
    def in_space(
        joint: SlidingDrive, linkage: LinkageConstraints, bodies: Mapping[str, pymunk.Body]
    ) -> Iterator[InSpace]:
        """A bar between moving bodies."""
        import pymunk

        if joint.drive.on != GROUND:
            on, body = (bodies[name] for name in joint.between)
            end, first = pair(linkage.back_end), pair(linkage.first_arm(joint.drive.body))
            yield InSpace(pymunk.PinJoint(on, body, end, first), DRIVE)

    def _bar(self, drive: Drive, q: PoseArray) -> ComplexArray:
        """The vector from a point far back on a driven body's guide to its first point, shape (n,)."""
        (z, turn), linkage = planes(q), self._linkage
        body, on = linkage.index[drive.body], linkage.index[drive.on]
        first = z[:, body] + linkage.first_arm(drive.body) * turn[:, body]
        return np.asarray(first - z[:, on] - linkage.back_end * turn[:, on])


RULES: Mapping[type[Joint], type[PymunkJoints]] = {
    Pin: PymunkPins,
    Guide: PymunkGuides,
    TurningDrive: PymunkTurningDrives,
    SlidingDrive: PymunkSlidingDrives,
}
