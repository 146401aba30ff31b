"""Joints and drives as the judge has them: for each type its equations, and what it does on the bodies."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.bodies import GROUND, Slide
from scenes.joints import Guide, Joint, Pin, SlidingDrive, TurningDrive
from scenes.model.motion import Samples

from .bodies import first_point
from .motion_vectors import MotionVectors, Vectors

Arms: TypeAlias = Mapping[str, Mapping[str, complex]]  # by body, or the ground: its points from the first, m


class Constraint(NamedTuple):
    """One equation: no distance, along a direction in the frame of a body, or a sum of angles."""

    first: str = GROUND
    second: str = GROUND
    arm: complex = 0  # on the first body, m
    other: complex = 0  # on the second, m
    along: complex = 0  # a unit vector, or zero of a sum of angles
    frame: str = GROUND
    angles: tuple[tuple[str, float], ...] = ()  # bodies, and how often each one's angle counts


class Between(NamedTuple):
    """What a joint does on a body, and the reaction on another: a force, N, at a place, m, and a moment, N m."""

    body: str
    other: str
    at: Vectors
    force: Vectors
    moment: Samples | float = 0.0


class JudgedJoint(ABC):
    """What one type of joint is by; `joint` is one of that type."""

    @abstractmethod
    def equations(self, joint: Any, scene: Scene, arms: Arms) -> Iterator[Constraint]:
        """Yield its equations in the order of its force channels; a multiplier is what the second does on the first."""

    @abstractmethod
    def acts(self, joint: Any, state: MotionVectors) -> Iterator[Between]:
        """Yield what it does, by its force channels."""

    def power(self, joint: Any, state: MotionVectors) -> Samples | None:  # noqa: ARG002
        """What it does, W, if it is a drive."""
        return None


class JudgedPin(JudgedJoint):
    """A pin: two distances."""

    def equations(self, joint: Pin, _: Scene, arms: Arms) -> Iterator[Constraint]:
        """Yield the distance along x, then along y."""
        # A `Constraint` is the place on its first body less that on its second, and its multiplier is a force on its
        # first. A force channel is what the joint's first body does on its second one: so the joint's second body is
        # the constraint's first.
        second, first = arms[joint.second][joint.point], arms[joint.first][joint.point]
        return (Constraint(joint.second, joint.first, second, first, axis) for axis in (1, 1j))

    def acts(self, joint: Pin, state: MotionVectors) -> Iterator[Between]:
        """Yield the force on the later body."""
        force = state.vector(*state.scene.channels.pins[joint.channel])
        yield Between(joint.second, joint.first, state.place(joint.point), force)


class JudgedGuide(JudgedJoint):
    """A guide: a distance across it, and a turn."""

    def equations(self, joint: Guide, scene: Scene, _: Arms) -> Iterator[Constraint]:
        """Yield the distance, then the turn."""
        slider, on = joint.slider, joint.slide.on
        # The direction is that of the guide turned by +90 degrees in the frame of what has the guide, and turns with
        # that.
        yield Constraint(slider, on, 0, _through(scene, joint.slide), 1j * complex(*joint.slide.along), on)
        yield _turned(slider, on)

    def acts(self, joint: Guide, state: MotionVectors) -> Iterator[Between]:
        """Yield the force across, and the moment, on the slider."""
        scene, names = state.scene, state.scene.channels.guides[joint.slider]
        slider = scene.bodies[joint.slider]
        across = state.motion[names.force] * 1j * state.along(slider)
        yield Between(joint.slider, joint.slide.on, state.place(slider.points[0]), across, state.motion[names.moment])


class JudgedTurningDrive(JudgedJoint):
    """A drive of an angle: a turn."""

    def equations(self, joint: TurningDrive, _: Scene, __: Arms) -> Iterator[Constraint]:
        """Yield the turn of the body against the other."""
        yield _turned(joint.drive.body, joint.drive.on)

    def acts(self, joint: TurningDrive, state: MotionVectors) -> Iterator[Between]:
        """Yield the torque."""
        drive, driven = joint.drive, state.scene.bodies[joint.drive.body]
        torque = state.motion[drive.effort_channel]
        none: Vectors = np.zeros(torque.shape, np.complex128)
        yield Between(drive.body, drive.on, state.place(driven.points[0]), none, torque)

    def power(self, joint: TurningDrive, state: MotionVectors) -> Samples:
        """The torque by the rate of the body against that on which it stands."""
        drive = joint.drive
        # Power of a torque between two bodies: only their rate on each other counts, since it acts on both with
        # opposite signs.
        rate = state.turning(drive.body)[1] - state.turning(drive.on)[1]
        return np.asarray(state.motion[drive.effort_channel] * rate)


class JudgedSlidingDrive(JudgedJoint):
    """A drive along a guide: a distance along that."""

    def equations(self, joint: SlidingDrive, scene: Scene, _: Arms) -> Iterator[Constraint]:
        """Yield the displacement along the guide."""
        body, slide = joint.drive.body, scene.slides[joint.drive.body]
        yield Constraint(body, slide.on, 0, _through(scene, slide), complex(*slide.along), slide.on)

    def acts(self, joint: SlidingDrive, state: MotionVectors) -> Iterator[Between]:
        """Yield the force along the guide."""
        drive, driven = joint.drive, state.scene.bodies[joint.drive.body]
        push = state.motion[drive.effort_channel] * state.along(driven)
        yield Between(drive.body, drive.on, state.place(driven.points[0]), push)

    def power(self, joint: SlidingDrive, state: MotionVectors) -> Samples:
        """The force by the rate along the guide."""
        drive = joint.drive
        return np.asarray(state.motion[drive.effort_channel] * state.sliding(state.scene.bodies[drive.body]))


RULES: Mapping[type[Joint], JudgedJoint] = {
    Pin: JudgedPin(),
    Guide: JudgedGuide(),
    TurningDrive: JudgedTurningDrive(),
    SlidingDrive: JudgedSlidingDrive(),
}


def _turned(body: str, on: str) -> Constraint:
    return Constraint(body, on, angles=((body, 1), (on, -1)))


def _through(scene: Scene, slide: Slide) -> complex:
    """Where a guide passes, m, from the first point of the body that has it, or from the ground's origin."""
    origin = 0j if slide.on == GROUND else first_point(scene.bodies[slide.on])
    return complex(*slide.through) - origin
