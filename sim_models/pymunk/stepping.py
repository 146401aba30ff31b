"""One run through the whole time: every step recorded, the drive and the forces set before it."""

from collections.abc import Sequence
from math import ceil

import numpy as np

from scenes import Failure, Sampling
from scenes.scene import ConstantSpeed

from .applied_forces import AppliedForces
from .constraints import Linkage, Poses
from .loads import Active
from .record import BatchRecord, PropertyRecord, Record
from .settings import PymunkSettings
from .space import Model, pair
from .start import move, rates

# Steps before t = 0: the joints' cached impulses start at zero, and the rates half a step early. The joints forget the
# latter within four steps, if their sweeps converge and each step corrects the whole error; the former with the sweeps,
# of which the first step has more. Where the linkage does not assemble that far back, fewer steps leave the first
# acceleration less exact.
PREROLL, LEAST_PREROLL = 5, 3
FIRST_SWEEPS = 10  # times those of a step


class Run:
    """The whole time at one step size dt, s; `loaded` says whether forces act on the bodies.

    Filled by `advance`: row k + 1 of `record`, shape (steps + 2, bodies, 6), holds the pose p_k and the rates v_k, so
    row 0 is one step before t = 0. Where forces act, `impulses`, shape (n, joints), N s, are the engine's own at the n
    samples, and `acts`, shape (n, press forces), says which of these it was given. `positions`, shape (steps + 1,), are
    the drive's.

    Raises:
        Failure: cannot_assemble, for the steps before t = 0; unsupported, the settings.
    """

    def __init__(
        self,
        linkage: Linkage,
        start: Poses,
        stroke_ends: Sequence[float],
        sampling: Sampling,
        stride: int,
        iterations: int,
        settings: PymunkSettings,
        *,
        loaded: bool = True,
    ) -> None:
        scene = linkage.scene
        self._linkage = linkage
        self._loaded = loaded
        self.stride = stride
        self.steps = stride * sampling.samples * sampling.turns
        self.dt = float(sampling.times(scene)[1]) / stride
        self.iterations = iterations

        self.preroll, pose = _before(linkage, start, self.dt, ceil(PREROLL / settings.corrected(self.dt)))
        # The place after the end tells the last rate.
        driven = scene.drive.at(self.dt * np.arange(-self.preroll, self.steps + 2, dtype=np.float64))
        self._driven = driven.position
        self.positions = self._driven[self.preroll : -1]
        rate = rates(linkage, pose, float(driven.rate[0]))
        self._model = Model(linkage, pose, rate, settings.error_bias(self.dt), settings.extra)
        self._space, self._bodies = self._model.space, self._model.bodies
        self.joints = self._model.joints if loaded else {}
        self._space.gravity = (scene.gravity if loaded else None) or (0, 0)
        self._forces = AppliedForces(linkage, self._bodies, stroke_ends, self.dt) if loaded else None
        self._follows_law = not isinstance(scene.drive, ConstantSpeed)

        bodies = self._bodies.values()
        by_property = settings.extra == "properties"
        self._record: Record = PropertyRecord(bodies) if by_property else BatchRecord(self._space, bodies)
        self.record: Poses = np.empty((self.steps + 2, len(self._bodies), 6))
        self.impulses = np.empty((sampling.count, len(self.joints)))
        self.acts: Active = np.zeros((sampling.count, len(stroke_ends)), dtype=np.bool_)

    @property
    def counters(self) -> dict[str, int]:
        """Steps, sweeps times constraints, and what each step goes over."""
        found = self._model.counters
        sweeps = self.iterations * (FIRST_SWEEPS - 1 + self.preroll + self.steps)
        return {"steps": self.preroll + self.steps, "constraint_iterations": sweeps * found["constraints"]} | found

    def advance(self) -> None:
        """Step from before t = 0 to the end."""
        space, record, joints = self._space, self._record, [*self.joints.values()]
        record.append()
        space.iterations = FIRST_SWEEPS * self.iterations
        for k in range(1 - self.preroll, self.steps + 1):
            if self._forces:
                self._forces.apply()
            if self._follows_law:
                self._drive(k)
            space.step(self.dt)
            record.append()
            if k <= 0:
                space.iterations = self.iterations
            if self._forces and k >= 0 and k % self.stride == 0:
                self.impulses[k // self.stride] = [joint.impulse for joint in joints]
                self.acts[k // self.stride] = self._forces.active
        self.record[:] = record.rows()[self.preroll - 1 :]

    def _drive(self, k: int) -> None:
        """Let the driven body be where the law has it at t_k, with the rate that takes it to where that is at t_{k+1}.

        pymunk moves it first, by that same rate; hence it starts from as far behind.
        """
        here, there = self._driven[k + self.preroll : k + self.preroll + 2]
        behind, rate = 2 * here - there, (there - here) / self.dt
        name, slide = self._linkage.scene.drive.body, self._linkage.scene.driven_slide
        body = self._bodies[name]
        if slide is None:
            body.angle, body.angular_velocity = behind, rate
        else:
            along = complex(*slide.along)
            body.position = pair(self._linkage.through(name) - self._linkage.first_arm(name) + behind * along)
            body.velocity = pair(rate * along)


def _before(linkage: Linkage, start: Poses, dt: float, wanted: int) -> tuple[int, Poses]:
    """Return how many steps to go before t = 0, as wanted or fewer, and the pose there.

    Raises:
        Failure: cannot_assemble, with the drive's position.
    """
    drive = linkage.scene.drive
    for steps in (wanted, LEAST_PREROLL):
        try:
            return steps, move(linkage, start, drive.start, float(drive.at(-steps * dt).position))
        except Failure as failure:
            found = failure
    raise Failure(found.status, f"pymunk starts {LEAST_PREROLL} steps before zero, where {found.reason}")
