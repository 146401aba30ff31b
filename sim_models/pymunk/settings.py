"""Settings of pymunk: what can be chosen, and every named setting in one place."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, TypeAlias

from scenes import Failure, Settings, Status

# Features that no scene needs, to measure what they cost: a shape on each body, which collide with nothing; a crank
# that is simulated and turned by a motor; a Python function in every step; every body read by its own properties.
PymunkExtra: TypeAlias = Literal["", "shapes", "motor", "callback", "properties"]
EXTRAS: Mapping[PymunkExtra, str] = {
    "shapes": "a shape on every body",
    "callback": "a Python callback each step",
    "properties": "read by properties",
    "motor": "a dynamic crank and a motor",
}

ERROR_BIAS = (1 - 0.1) ** 60  # pymunk's default: the part of a joint's error left after a second
SECONDS = 600.0  # of processor time for a run's steps; the slowest setting takes 5 for a cycle of a shipped scene


@dataclass(frozen=True)
class PymunkSettings(Settings):
    """Steps, sweeps and Richardson extrapolation with an order of convergence; see `engine`."""

    steps: Annotated[int, "per cycle of the coarsest run, at least: rounded up to a multiple of the samples"]
    levels: Annotated[int, "runs for the Richardson extrapolation, 1 to 4, each with twice the steps of the last"]
    iterations: Annotated[int, "Gauss-Seidel sweeps over all joints per step"]  # with none the C core ends the process
    correction: Annotated[float | None, "part of a joint's error that a step corrects; none: pymunk's default"] = 1.0
    fictitious: Annotated[bool, "masses with which sweeps converge fast, in place of the true ones"] = False
    extra: Annotated[PymunkExtra, "what is modelled besides"] = ""

    def corrected(self, dt: float) -> float:
        """The part of a joint's error that a step of dt, s, corrects."""
        return float(1 - self.error_bias(dt) ** dt)

    def error_bias(self, dt: float) -> float:
        """The part of a joint's error left after a second, pymunk's parameter, for steps of dt, s."""
        if self.correction is None:
            return ERROR_BIAS
        # Chipmunk defines the bias per second: a step of dt leaves bias^dt of an error.
        left = 1 - self.correction
        bias = float(left ** (1 / dt))
        if left and not bias:  # so small a number that pymunk would correct the whole error
            raise Failure(Status.unsupported, f"pymunk cannot leave {left:g} of an error over in steps of {dt:.3g} s")
        return bias


@dataclass(frozen=True)
class TextbookSettings(Settings):
    """The set-up of the manual's examples, with pymunk's defaults; see `runs.stepping`."""

    steps: Annotated[int, "per cycle, at least: rounded up to a multiple of the samples"]
    iterations: Annotated[int, "Gauss-Seidel sweeps over all joints per step"] = 10


AnySettings: TypeAlias = PymunkSettings | TextbookSettings


def _run(steps: int, levels: int, sweeps: int, kind: str = "", **options: Any) -> PymunkSettings:
    """Return settings of one family but for the steps; without options, with the true masses but for ballast."""
    runs = "+".join(str(steps * 2**level) for level in range(levels))
    family = f"{'one level' if levels == 1 else f'{levels} levels'}, {sweeps} sweeps{kind}"
    options = {"family": family, "order": levels + 1, **options}
    return PymunkSettings(f"{runs} steps, {sweeps} sweeps{kind}", steps, levels, sweeps, **options)


def _fictitious(steps: int, levels: int, sweeps: int, **options: Any) -> PymunkSettings:
    note = "fictitious masses: the forces follow from the motion, they are no check of their own"
    return _run(steps, levels, sweeps, ", fictitious masses", fictitious=True, note=note, **options)


def _textbook(steps: int) -> TextbookSettings:
    """A first script's settings; unconverged sweeps and a slack correction add up to no known order."""
    note = "as a new user meets it: the engine's own defaults, all links dynamic, a motor on the crank"
    return TextbookSettings(f"textbook, {steps} steps", steps, family="textbook", note=note, drive_promise=0.1)


# Measured good to 1 % in the reactions of every shipped scene.
FAST = _fictitious(144, 2, 20, promise=1e-2)
# A sweep over true masses leaves up to 0.993 of an error, near the singular configurations of the shipped scenes: 500
# leave 3 %, and each step starts from the impulses of the one before.
DEFAULT = _run(360, 2, 500, promise=1e-2)
EXACT = _fictitious(288, 4, 200, promise=1e-4)

# Every run measures these: what is the cheapest for some error, an order of convergence, and a first script.
WORK_PRECISION: tuple[AnySettings, ...] = (
    FAST,
    *(_run(steps, 1, 100) for steps in (72, 144, 288)),
    _run(144, 2, 150),
    DEFAULT,
    _textbook(60),
)
SLACK = "the engine's own correction of joints, a tenth of their error in 1/60 s"
SLACK_STEPS = (720, 1440, 2880, 5760)
LONG_WORK_PRECISION: tuple[AnySettings, ...] = (
    *(_fictitious(steps, 1, 20) for steps in (72, 144, 288, 576, 1152, 2304, 4608, 9216)),
    *(_fictitious(steps, 2, 20) for steps in (72, 288, 576, 1152)),
    *(_fictitious(steps, 3, 20) for steps in (72, 144, 288, 576)),
    *(_fictitious(steps, 4, 20) for steps in (72, 144)),
    *(_run(steps, 1, 100) for steps in (576, 1152, 2304, 4608, 9216)),
    *(_run(steps, 2, 150) for steps in (72, 288, 576)),
    *(_run(steps, 3, 300) for steps in (72, 144, 288)),
    *(_run(steps, 4, 300) for steps in (72, 144)),
    EXACT,
    *(_run(steps, 1, 100, ", 50% correction", correction=0.5, order=2) for steps in (144, 360, 720)),
    *(_run(steps, 1, 100, ", default correction", correction=None, order=1, note=SLACK) for steps in SLACK_STEPS),
    *(_textbook(steps) for steps in (576, 1152, 2304, 4608, 9216, 18432, 36864)),
)
# A motor converges badly: fewer sweeps flip the toggle press.
_bases = dict.fromkeys(EXTRAS, DEFAULT) | {"motor": _run(360, 2, 2000, drive_promise=0.1)}
ABLATIONS: tuple[PymunkSettings, ...] = tuple(
    replace(base, label=f"{base.label}, {EXTRAS[extra]}", extra=extra) for extra, base in _bases.items()
)


def at_steps(steps: int, iterations: int = DEFAULT.iterations) -> PymunkSettings:
    """The settings of one run with that many steps per cycle and sweeps per step, for maps of stability."""
    return _run(steps, 1, iterations)
