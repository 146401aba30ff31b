"""One cycle of one linkage by the reference: the output's curves, and quantities by which linkages are compared."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import nan
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Sampling, Scene
from scenes.motion import Samples
from scenes.scene import Force, PressForce

from ..engines.axis import axis

Solve: TypeAlias = Callable[[Samples], Motion]  # instants, s, shape (n,) -> the reference's motion
Curves: TypeAlias = Mapping[str, Samples]  # by name, SI, each of shape (n,)
Extremes: TypeAlias = Mapping[str, tuple[float, float]]  # of each curve, the least and the largest value

SAMPLING = Sampling(3600)
FINE, ROUNDS = 30, 2  # parts of a step around each extreme, time and again: to 1e-3 of the samples' own steps
NEAR = 0.01  # of the stroke: so near to the bottom the slider dwells
REST = 1e-9  # of the peak speed: so slow the slider stands still

UNITS: Mapping[str, str] = {
    "stroke": "m",
    "bottom": "m",
    "dwell": "s",
    "dwell share": "",
    "quick return": "",
    "peak velocity": "m/s",
    "peak acceleration": "m/s^2",
    "peak reaction": "N",
    "peak torque": "N*m",
    "peak force": "N",
    "least transmission": "rad",
}  # of the quantities, in the order of the tables


@dataclass(frozen=True)
class Cycle:
    """One linkage over one cycle of its drive."""

    position: Samples  # on the axis of the curves, SI: of the drive, or the time under a law
    curves: Curves  # of the output, the drive and the joints
    quantities: Mapping[str, float]  # by name, SI
    joints: Mapping[str, str]  # by quantity, the joint where it is found


def cycle(scene: Scene, motion: Motion, solve: Solve) -> Cycle:
    """Return the curves and quantities of a cycle, given the motion at the instants of `SAMPLING`.

    Raises:
        Failure: the linkage cannot be assembled between two samples, where `solve` refines an extreme.
    """
    time = SAMPLING.times(scene)
    curves = _curves(scene, motion)
    extremes = _extremes(scene, time, curves, solve)
    peaks = (name for name in ("velocity", "acceleration", "torque", "force") if name in extremes)
    quantities = {f"peak {name}": max(map(abs, extremes[name])) for name in peaks}
    if "displacement" in curves:
        closing = _closing(scene)
        quantities |= _stroke(time, curves["displacement"], extremes["displacement"], closing)
        quantities["quick return"] = _quick_return(time, curves["velocity"], closing) if scene.drive.repeats else nan
    else:
        quantities["stroke"] = float(np.hypot(*(np.ptp(extremes[axis]) for axis in ("x", "y"))))
    joints = {}
    for name, curve, worst in (("peak reaction", ".reaction", max), ("least transmission", ".transmission", min)):
        values = {key.removesuffix(curve): ends[worst is max] for key, ends in extremes.items() if key.endswith(curve)}
        if values:
            joints[name] = worst(values, key=values.__getitem__)
            quantities[name] = values[joints[name]]
    return Cycle(motion[axis(scene).channel], curves, quantities, joints)


def _curves(scene: Scene, motion: Motion) -> dict[str, Samples]:
    """Return the output's curves, along its guide if any, the drive's effort, pins' forces and transmission angles."""
    place, velocity, acceleration = (
        np.array([motion[f"{scene.output}.{q}x"], motion[f"{scene.output}.{q}y"]]) for q in ("", "v", "a")
    )
    guided = scene.guided(scene.output)
    if guided is None:
        curves = {"x": place[0], "y": place[1]}
        curves |= {"velocity": np.hypot(*velocity), "acceleration": np.hypot(*acceleration)}
    else:
        along, through = np.array(guided[1].along), np.array(guided[1].through)
        curves = {"displacement": along @ (place - through[:, None])}
        curves |= {"velocity": along @ velocity, "acceleration": along @ acceleration}
    for channel, values in motion.samples.items():
        stem, _, measured = channel.rpartition(".")
        if stem == "drive" and measured in ("torque", "force"):
            curves[measured] = values
        elif measured == "transmission":
            curves[channel] = values
        elif measured == "fx":
            curves[f"{stem}.reaction"] = np.hypot(values, motion[f"{stem}.fy"])
    return curves


def _extremes(scene: Scene, time: Samples, sampled: Curves, solve: Solve) -> Extremes:
    """Refine every curve's extremes by finer samples, as far as the next ones, around those where they are found."""
    found, step = time[_ends(sampled)], time[1]
    for _ in range(ROUNDS):
        fine = np.add.outer(np.unique(found), step * np.linspace(-1, 1, 2 * FINE + 1)).ravel()
        if not scene.drive.repeats:
            fine = np.clip(fine, 0, time[-1])
        close = _curves(scene, solve(fine))
        found, step = fine[_ends(close)], step / FINE
    return {name: (float(values.min()), float(values.max())) for name, values in close.items()}


def _ends(curves: Curves) -> NDArray[np.intp]:
    """Return where every curve is least and where it is largest."""
    return np.array([(values.argmin(), values.argmax()) for values in curves.values()])


# --- a slider's stroke -----------------------------------------------------------------------------------------------


def _closing(scene: Scene) -> int:
    """Return the sign of the slider's velocity while it closes: against its first load, or else downwards."""
    guided = scene.guided(scene.output)
    assert guided is not None
    name, slide = guided
    for load in scene.loads:
        if load.body != name:
            continue
        if isinstance(load, PressForce):
            return load.closing
        push = np.dot(load.force, slide.along) if isinstance(load, Force) else max(load.forces, key=abs)
        if push != 0:
            return -1 if push > 0 else 1
    return -1 if slide.along[1] >= 0 else 1


def _stroke(time: Samples, displacement: Samples, ends: tuple[float, float], closing: int) -> dict[str, float]:
    """Return the stroke, its bottom, where the closing stroke ends, and for how long the slider is `NEAR` that."""
    stroke = ends[1] - ends[0]
    bottom = ends[closing > 0]
    dwell = _time_below_zero(time, np.abs(displacement - bottom) - NEAR * stroke)
    return {"stroke": stroke, "bottom": bottom, "dwell": dwell, "dwell share": dwell / time[-1]}


def _time_below_zero(time: Samples, values: Samples) -> float:
    """Return for how long a curve of straight lines through the samples is below zero."""
    low, high = np.minimum(values[:-1], values[1:]), np.maximum(values[:-1], values[1:])
    share = np.divide(-low, high - low, out=np.where(low <= 0, 1.0, 0.0), where=high > low)
    return float(np.sum(np.diff(time) * np.clip(share, 0, 1)))


def _quick_return(time: Samples, velocity: Samples, closing: int) -> float:
    """Return the time of the closing stroke over that of the return; NaN unless a cycle has one of each."""
    outwards = velocity > REST * np.abs(velocity).max()
    (turns,) = np.nonzero(outwards[:-1] != outwards[1:])
    if len(turns) != 2:
        return nan
    before, after = velocity[turns], velocity[turns + 1]
    first, second = time[turns] + time[1] * before / (before - after)
    inner, outer = second - first, time[-1] - (second - first)  # the stroke between the turns, and the one around them
    return float(inner / outer if outwards[turns[1]] == (closing > 0) else outer / inner)
