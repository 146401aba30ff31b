"""pymunk, an impulse-based physics engine, set up to be a second-order solver of linkages.

Chipmunk, its C core, steps a linkage like a leapfrog, provided that its joints correct their whole position error in
every step (`error_bias` = 0; the default leaves an error of first order, enough to flip a toggle linkage):

    p_k = p_{k-1} + dt v_{k-1},    M (v_k - v_{k-1}) / dt = F + J(p_k)^T lambda_k,    J(p_k) v_k = -C(p_k) / dt

The rates v_k belong to t_k + dt/2. Hence at t_k the velocity is (v_{k-1} + v_k) / 2, the acceleration (v_k - v_{k-1}) /
dt and the reaction lambda_k, with errors in dt^2, dt^3 and so on, which Richardson extrapolation over dt, dt/2, dt/4
and dt/8 removes one after the other. Where a motion law has a knot, the acceleration a kink, its mean over a step is
off by the first order, which `channels` corrects. Loads, springs and reactions belong to the extrapolated motion: the
kinks of a force table and the switch of a press force are where that has them. The accuracy of the last equation
depends on the number of Gauss-Seidel sweeps, `iterations`: with too few the linkage flips to another branch, whatever
dt. The masses determine how many are enough.

A drive against the ground prescribes its body's motion. One between moving bodies is a joint, see `space`: then all
masses are chosen for the sweeps, of which there are as many as it takes, and the forces follow from the motion alone.
"""

from scenes import Request, Scene
from scenes.drive import KINDS as DRIVES
from scenes.elements import kinds_of
from scenes.model.engine import Simulation

from . import settings as named
from .contacts import CONTACTS
from .elements import RULES
from .joints import RULES as JOINTS
from .settings import AnySettings, PymunkSettings

KINDS = kinds_of((*RULES, *CONTACTS, *JOINTS)) | DRIVES
DEFAULT, FAST, EXACT, ABLATIONS = named.DEFAULT, named.FAST, named.EXACT, named.ABLATIONS
WORK_PRECISION, LONG_WORK_PRECISION, at_steps = named.WORK_PRECISION, named.LONG_WORK_PRECISION, named.at_steps


def version() -> str:
    """The versions of pymunk and of Chipmunk, its C core."""
    import pymunk  # late, here and below: nothing of it is loaded before it runs

    return f"pymunk {pymunk.version}, Chipmunk {pymunk.chipmunk_version.partition('-')[0]}"


def iterations_needed(scene: Scene, settings: PymunkSettings) -> float:
    """The number of sweeps that a step needs, see `sweeps`."""
    from . import sweeps

    return sweeps.iterations_needed(scene, settings)


def build(scene: Scene, settings: AnySettings, request: Request) -> Simulation:
    """Prepare one run, or one for each level, from a consistent start, see `scenes.model.engine.Engine.build`.

    Failure: `unsupported`, pymunk has no body, joint, load or drive for something, or the request is for positions of
    the drive; `cannot_assemble` or `not_converged`, no pose on the sketch's branch, with the drive's position.
    """
    from .runs.simulation import PymunkSimulation

    return PymunkSimulation(scene, settings, request)
