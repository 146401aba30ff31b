"""The scene's channels at one sample: motion of points and bodies, and the forces in all joints."""

import numpy as np

from scenes.motion import Samples

from ..coordinates.poses import ClosedPose
from .closures import Closures
from .loads import applied, held, inverse_dynamics
from .tree import Bodies


def kinematics(closures: Closures, q: Samples, bodies: Bodies) -> dict[str, float]:
    """Return the channels that describe the motion, but the time."""
    scene, tree = closures.tree.scene, closures.tree
    angles = tree.turns @ q
    driven = closures.driven_guide
    found = {scene.drive_channel: angles[closures.driven] if driven is None else closures.along_guide(bodies, driven)}
    for point in scene.moving_points:
        held = closures.held(scene.owners[point][0], point)
        for level, of in (("", bodies.place), ("v", bodies.velocity), ("a", bodies.acceleration)):
            vector = of(*held)
            found |= {f"{point}.{level}x": vector.real, f"{point}.{level}y": vector.imag}
    for name in scene.turning:
        row = tree.index[name]
        found |= {
            f"{name}.angle": angles[row],
            f"{name}.omega": bodies.spin[row],
            f"{name}.alpha": bodies.spin_rate[row],
        }
    return found


def forces(
    closures: Closures, pose: ClosedPose, bodies: Bodies, rates: tuple[Samples, Samples], ends: Samples
) -> dict[str, float]:
    """Return the force channels: of closed loops by their multipliers, of the tree's joints by the recursion.

    Raises:
        Failure: `nonfinite`, a spring has no direction.
    """
    tree, motion, loads = closures.tree, (closures.units * pose.x, *rates), list(applied(closures, bodies, ends))
    needed = closures.units * inverse_dynamics(closures, bodies, motion, loads)
    multipliers = np.linalg.solve(pose.J.T, needed) / closures.row_units
    inverse_dynamics(closures, bodies, motion, [*loads, *held(closures, bodies, multipliers)])
    names = [f"{name}.{part}" for name in closures.pins for part in ("fx", "fy")]
    names += [f"{name}.{part}" for name in closures.sliders for part in ("guide_force", "guide_moment")]
    found = dict(
        zip([*names, "drive.torque" if closures.driven_guide is None else "drive.force"], multipliers, strict=True)
    )
    first_of = {pin.channel: pin.first for pin in tree.scene.pins}
    for joint in tree.joints:
        row, exerted = tree.index[joint.child], tree.data.f[tree.number[joint.child]]  # by the parent on the child
        force = complex(*exerted.linear[:2]) * bodies.turn[row]
        if joint.turns:
            on_second = force if first_of[joint.name] == joint.parent else -force
            found |= {f"{joint.name}.fx": on_second.real, f"{joint.name}.fy": on_second.imag}
            continue
        guide = closures.guides[joint.name]
        axis, _ = closures.on_guide(bodies, guide)
        about = ((bodies.at[row] - bodies.place(*guide.first)).conjugate() * force).imag
        moment = exerted.angular[2] + about
        sign = 1 if joint.child == joint.name else -1
        found |= {f"{joint.name}.guide_force": sign * (axis.conjugate() * force).imag}
        found |= {f"{joint.name}.guide_moment": sign * moment}
    return found
