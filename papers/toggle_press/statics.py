"""Toggle press: the variables of the kinetostatics, over a turn by the reference, with any signs of the forces.

The figure with the directions of the forces is not to hand: each printed force may be the reference's with
either sign.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy import cos, sin
from numpy.typing import NDArray

from compare.mechanics.bodies import inertia
from compare.mechanics.motion_vectors import MotionVectors
from scenes import Motion, Scene
from scenes.loads import Force
from scenes.model.motion import Samples

from .variables import bars

CHANNELS = {"RP": "P1", "RP2": "P2", "RO": "O", "RP3": "P3", "RP4": "P4", "RP5": "P5"}  # forces, and their pins
FORCES = tuple(f"{name}{axis}" for name in CHANNELS for axis in "xy")


@dataclass(frozen=True)
class Statics:
    """The paper's symbols, SI; forces of shape (n,) or, for m choices of their signs, (m, n)."""

    F: Mapping[str, Samples]  # the paper's F_RP2x is F["RP2x"]
    Md: Samples
    N: Samples  # of the slider on its guide, which the paper leaves out
    Q: Samples
    mg: float  # of the slider
    mx: Sequence[Samples]  # mass times acceleration, by component: crank, rocker, toggle, rod, slider
    my: Sequence[Samples]
    Ja: Sequence[Samples]
    t: Sequence[Samples]  # theta, theta_1 ... theta_5
    L: Sequence[float]  # L0 ... L5
    Ls: Sequence[float]  # from the first hinge to the centre of mass, by component
    arms: Mapping[str, tuple[Samples, Samples]]  # from the toggle's centre of mass to its pins
    lever: tuple[Samples, Samples]  # Ls2 (cos(phi), sin(phi)), which the paper does not give

    @property
    def scale(self) -> Mapping[str, tuple[float, str]]:
        """Return scale and unit of each kind of equation: the largest force, and that times l1 = 300 mm."""
        force = max(float(np.abs(f).max()) for f in self.F.values())
        return {"force": (force, "N"), "moment": (force * self.L[1], "N m")}


def statics(scene: Scene, motion: Motion) -> Statics:
    """The statics of the toggle press in a motion, with the reference's signs."""
    state = MotionVectors(scene, motion)
    bodies = [scene.bodies[name] for name in ("crank", "rocker", "toggle", "rod", "slider")]
    coms = [state.com(body) for body in bodies]
    place = {point: state.point(point)[0] for point in ("O", *(f"P{k}" for k in range(1, 6)))}
    masses, along = [body.mass or 0.0 for body in bodies], bars(state)
    arms = {point: place[point] - coms[2][0] for point in ("P2", "P3", "P4")}
    still = np.zeros_like(motion["time"])
    (resistance,) = (load for load in scene.loads if isinstance(load, Force))
    return Statics(
        {name: motion[f"{CHANNELS[name[:-1]]}.f{name[-1]}"] for name in FORCES},
        motion["drive.torque"],
        motion["slider.guide_force"],  # on the slider to the left, hence of the slider to the right
        np.full_like(still, resistance.force[1]),
        masses[-1] * 9.81,
        [mass * a.real for mass, (_, _, a) in zip(masses, coms, strict=True)],
        [mass * a.imag for mass, (_, _, a) in zip(masses, coms, strict=True)],
        [inertia(body) * state.turning(body.name)[2] for body in bodies],
        [np.angle(bar) for bar in along],
        [float(np.abs(bar).mean()) for bar in along],
        [float(np.abs(com[0] - place[p]).mean()) for com, p in zip(coms, ("P1", "O", "P2", "P4", "P5"), strict=True)],
        {point: (arm.real, arm.imag) for point, arm in arms.items()},
        (still, still),
    )


def signed(s: Statics, signs: NDArray[np.float64]) -> Statics:
    """The forces and the resistance with other signs, in the order of `FORCES`, Q last."""
    *of_forces, of_q = signs
    return replace(s, F={name: sign * s.F[name] for name, sign in zip(FORCES, of_forces, strict=True)}, Q=of_q * s.Q)


def fitted(s: Statics) -> Statics:
    """The statics with the Ls2 and phi of (30.3) that fit it best, as the paper gives neither."""
    columns = np.stack([lever_moment(s, 0.0), lever_moment(s, np.pi / 2)], axis=-1)
    inertial = np.broadcast_to(-s.Ja[2], columns.shape[:-1])[..., None]
    fit = (np.linalg.pinv(columns) @ inertial)[..., 0]
    return replace(s, lever=(fit[..., :1], fit[..., 1:]))


def lever_moment(s: Statics, phi: float) -> Samples:
    """The forces' part of the printed (30.3), for an Ls2 of one."""
    F, t2, t3, t4 = s.F, s.t[2], s.t[3], s.t[4]
    at_2 = -F["RP2x"] * sin(t2 + phi) - F["RP2y"] * cos(t2 + phi)
    at_3 = -F["RP3x"] * sin(t3 + phi) - F["RP3y"] * sin(t3 + phi)
    return np.asarray(at_2 + at_3 + F["RP4x"] * sin(t4 + phi) - F["RP4y"] * sin(t4 + phi))
