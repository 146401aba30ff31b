"""pymunk, an impulse-based physics engine, set up to be a second-order solver of linkages.

Chipmunk, its C core, steps a linkage like a leapfrog, provided that its joints correct their whole position error in
every step (`error_bias` = 0; the default leaves an error of first order, enough to flip a toggle linkage):

    p_k = p_{k-1} + dt v_{k-1},    M (v_k - v_{k-1}) / dt = F + J(p_k)^T lambda_k,    J(p_k) v_k = -C(p_k) / dt

The rates v_k belong to t_k + dt/2. Hence at t_k the velocity is (v_{k-1} + v_k) / 2, the acceleration
(v_k - v_{k-1}) / dt and the reaction lambda_k, with errors in dt^2, dt^3 and so on, which Richardson extrapolation over
dt, dt/2, dt/4 and dt/8 takes away one after the other. Only where a motion law has a knot, the acceleration a kink, its
mean over a step is off by the first order. How well Gauss-Seidel sweeps solve the last equation is for `iterations`:
too few do not blur the result but flip the linkage, whatever dt. How many are enough is a matter of the masses.
"""

from collections.abc import Mapping

from scenes import Request, Scene

from .settings import Extra, PymunkSettings, Textbook
from .simulation import PymunkSimulation
from .sweeps import iterations_needed
from .textbook import TextbookSimulation

__all__ = [
    "ABLATIONS",
    "DEFAULT",
    "EXACT",
    "FAST",
    "LADDER",
    "LONG_LADDER",
    "PymunkSettings",
    "Textbook",
    "at_steps",
    "build",
    "iterations_needed",
    "version",
]

FICTITIOUS = "fictitious masses: the forces follow from the motion, they are no check of their own"
NEWCOMER = "as a new user meets it: the engine's own defaults, all links dynamic, a motor on the crank"
SLACK = "the engine's own correction of joints, a tenth of their error in 1/60 s"
EXTRAS: Mapping[Extra, str] = {
    "shapes": "a shape on every body",
    "callback": "a Python callback each step",
    "properties": "read by properties",
    "motor": "a dynamic crank and a motor",
}
MOTOR_SWEEPS = 2000  # a motor converges badly: fewer flip the toggle press


def _true(steps: int, levels: int, sweeps: int, extra: Extra = "") -> PymunkSettings:
    label = f"{_runs(steps, levels)} steps, {sweeps} sweeps" + (f", {EXTRAS[extra]}" if extra else "")
    family = f"{_levels(levels)}, {sweeps} sweeps"
    return PymunkSettings(label, steps, levels, sweeps, extra=extra, family=family, order=levels + 1)


def _fictitious(steps: int, levels: int, sweeps: int) -> PymunkSettings:
    label = f"{_runs(steps, levels)} steps, {sweeps} sweeps, fictitious masses"
    family = f"{_levels(levels)}, {sweeps} sweeps, fictitious masses"
    order = levels + 1
    return PymunkSettings(label, steps, levels, sweeps, fictitious=True, family=family, order=order, note=FICTITIOUS)


def _correcting(steps: int, sweeps: int, correction: float | None) -> PymunkSettings:
    part, order, note = ("default", 1, SLACK) if correction is None else (f"{correction:.0%}", 2, "")
    kind = f"{sweeps} sweeps, {part} correction"
    label, family = f"{steps} steps, {kind}", f"{_levels(1)}, {kind}"
    return PymunkSettings(label, steps, 1, sweeps, correction, family=family, order=order, note=note)


def _textbook(steps: int) -> Textbook:
    """Return what one gets without knowing; no theory says how unconverged sweeps and a slack correction add up."""
    return Textbook(f"textbook, {steps} steps", steps, family="textbook", note=NEWCOMER)


def _runs(steps: int, levels: int) -> str:
    return "+".join(str(steps * 2**level) for level in range(levels))


def _levels(levels: int) -> str:
    return "one level" if levels == 1 else f"{levels} levels"


# Measured good to 1 % in the reactions of every shipped scene.
FAST = _fictitious(144, 2, 20)
# A sweep over true masses leaves up to 0.993 of an error, near the locks of the shipped scenes: 500 leave 3 %, and each
# step starts from what the one before left.
DEFAULT = _true(360, 2, 500)
EXACT = _fictitious(288, 4, 200)

LADDER: tuple[PymunkSettings | Textbook, ...] = (
    FAST,
    _fictitious(144, 3, 20),
    *(_true(steps, 1, 100) for steps in (144, 288)),
    _true(144, 2, 150),
    *(_true(steps, 3, 300) for steps in (72, 144)),
    DEFAULT,
    _correcting(720, 100, None),
    *(_textbook(steps) for steps in (60, 2304)),
)
LONG_LADDER: tuple[PymunkSettings | Textbook, ...] = (
    *(_fictitious(steps, 1, 20) for steps in (72, 144, 288, 576, 1152, 2304, 4608, 9216)),
    *(_fictitious(steps, 2, 20) for steps in (72, 288, 576, 1152)),
    *(_fictitious(steps, 3, 20) for steps in (72, 288, 576)),
    *(_fictitious(steps, 4, 20) for steps in (72, 144)),
    *(_true(steps, 1, 100) for steps in (72, 576, 1152, 2304, 4608, 9216)),
    *(_true(steps, 2, 150) for steps in (72, 288, 576)),
    _true(288, 3, 300),
    *(_true(steps, 4, 300) for steps in (72, 144)),
    EXACT,
    *(_correcting(steps, 100, 0.5) for steps in (144, 360, 720)),
    *(_correcting(steps, 100, None) for steps in (1440, 2880, 5760)),
    *(_textbook(steps) for steps in (576, 1152, 4608, 9216, 18432, 36864)),
)
ABLATIONS: tuple[PymunkSettings, ...] = (
    *(_true(360, 2, 500, extra) for extra in ("shapes", "callback", "properties")),
    _true(360, 2, MOTOR_SWEEPS, "motor"),
)


def at_steps(steps: int, iterations: int = DEFAULT.iterations) -> PymunkSettings:
    """Return one run of that many steps a cycle, for maps of where the steps are stable."""
    return _true(steps, 1, iterations)


def version() -> str:
    """Return the versions of pymunk and of Chipmunk, its C core."""
    import pymunk

    return f"pymunk {pymunk.version}, Chipmunk {pymunk.chipmunk_version.partition('-')[0]}"


def build(scene: Scene, settings: PymunkSettings | Textbook, request: Request) -> PymunkSimulation | TextbookSimulation:
    """Prepare one run, or one for each level, from a consistent start.

    Raises:
        Failure: unsupported, what pymunk has no body, joint or drive for; cannot_assemble, with the drive's position.
    """
    if isinstance(settings, Textbook):
        return TextbookSimulation(scene, settings, request)
    return PymunkSimulation(scene, settings, request)
