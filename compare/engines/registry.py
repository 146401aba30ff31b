"""The one place that knows the engines' names, and what they offer. A module is imported when its engine runs."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from importlib import import_module
from typing import Any, Protocol, TypeAlias, cast

import numpy as np

from scenes import Engine, InputError, Inputs, Motion, Scene, Settings, Status
from scenes.errors import nearest
from scenes.model.enclosures import Assemblies, Enclosures, MotionRange, SketchFit
from scenes.model.engine import completed
from scenes.model.motion import Request, Samples

from . import outside
from .outside import Entry as Entry
from .processes.inside import Ended

Solve: TypeAlias = Callable[[Inputs], Motion]
REMEMBERED, FEW = 4, 4096  # motions, of samples at most
ByName: TypeAlias = Mapping[str, Samples]  # of channels, or of numbers of the scene file by their paths


class Remembering:
    """A solver that solves nothing twice: every engine's run of few samples is held against the same ones."""

    def __init__(self, solve: Solve) -> None:
        self.solve = solve
        self._once = lru_cache(REMEMBERED)(_of_bytes(solve))

    def __call__(self, inputs: Inputs) -> Motion:
        """The motion at inputs."""
        if len(inputs.time) > FEW:
            return self.solve(inputs)
        arrays = (np.asarray(array, np.float64) for array in (inputs.time, *inputs.derivatives))
        return self._once(*((array.shape, array.tobytes()) for array in arrays))

    def __reduce__(self) -> tuple[type["Remembering"], tuple[Solve]]:
        """Have what it remembers stay in this process."""
        return Remembering, (self.solve,)


def _of_bytes(solve: Solve) -> Callable[..., Motion]:
    """The same of the shapes and the bytes of the arrays of inputs, which can be compared as they are."""

    def solved(*packed: tuple[tuple[int, ...], bytes]) -> Motion:
        time, *derivatives = (np.frombuffer(content).reshape(shape) for shape, content in packed)
        return solve(Inputs(time, derivatives))

    return solved


class Many(Protocol):
    """The motions of m machines, as the analytic core returns them."""

    samples: ByName  # shape (m, n), SI; NaN where a machine does not assemble
    status: Sequence[Status]  # how each machine ended
    reason: Sequence[str]  # why it is not ok, in a sentence; empty where it is


SolveMany: TypeAlias = Callable[[Samples, Samples], Many]  # positions of the drive and instants, shape (m, n)


REFERENCE = "analytic"
_CORE = "vector equations: dyads in closed form, larger groups by Newton; the reference"
_FLINT = "50 digits, Newton on the constraints; certifies the reference's floor"
_OWN = (  # name, what it is, its package and distribution, and the extra of this project that brings them
    (REFERENCE, _CORE, "numpy", "numpy", ""),
    ("exudyn", "multibody DAE with Lagrange multipliers", "exudyn", "exudyn", ""),
    ("pymunk", "impulses, block Gauss-Seidel", "pymunk", "pymunk", ""),
    ("casadi", "Lagrange's equations, every derivative by automatic differentiation", "casadi", "casadi", "casadi"),
    ("mujoco", "springs and dampers for joints, made as hard as a step allows", "mujoco", "mujoco", "mujoco"),
    ("pinocchio", "joint coordinates, closed loops, recursive Newton-Euler", "pinocchio", "pin", "pinocchio"),
    ("multiprecision", _FLINT, "flint", "python-flint", "certify"),
)
OWN = {  # each gives every channel of every scene that it can model
    name: Entry(
        *(purpose, f"{'' if name == REFERENCE else 'sim_models.'}{name}.engine", package, distribution),
        install="pip install " + (f"'linkage-crosscheck[{extra}]'" if extra else package),
    )
    for name, purpose, package, distribution, extra in _OWN
}
ENTRIES: Mapping[str, Entry] = OWN | outside.entries(OWN)
DEFAULT_ENGINES = (REFERENCE, "exudyn", "pymunk")
ORACLE = "multiprecision"
TIERS = ("fast", "balanced", "exact")  # settings by name
WORK_PRECISION, ABLATION = "work-precision", "ablation"  # their roles: from cheap to accurate; more than a scene needs
Accuracy: TypeAlias = str | float  # one of `TIERS`, or the largest relative error
ALIKE = frozenset({"casadi", "mujoco", "pinocchio"})  # they share how a linkage is assembled, `sim_models.coordinates`


def voter(name: str) -> str:
    """Return an engine's name; engines that assemble a linkage alike have one between them, being one opinion."""
    return min(ALIKE) if name in ALIKE else name


def check_names(names: Iterable[str]) -> None:
    """Raise InputError for the first name that is no engine's."""
    for name in names:
        if name not in ENTRIES:
            raise InputError(f"--engines: no engine '{name}'{nearest(name, ENTRIES)}")


def engine(name: str) -> Engine[Any]:
    """An engine's offer: what its module has, or of one from outside its settings, without its code."""
    entry = ENTRIES[name]
    return outside.offered(entry)[0] if entry.outside else completed(import_module(entry.module), entry.version)


def refused(name: str) -> Ended | None:
    """Return how the import of an engine ended that cannot be imported, where that was tried by itself."""
    entry = ENTRIES[name]
    return outside.offered(entry)[1] if entry.outside and not entry.missing else None


def imported(name: str) -> Engine[Any]:
    """Return an engine to run it in this process, imported now with what does its work: no clock times that."""
    entry = ENTRIES[name]
    if entry.outside:
        return outside.imported(entry)
    found = engine(name)  # first: Exudyn's package prepares the import
    import_module(entry.package)
    return found


def reference(scene: Scene, channels: frozenset[str] | None = None) -> Solve:
    """Return the analytic core's solver of a scene for some channels or all, against which every engine is measured.

    Both raise Failure: where the core cannot take the scene apart, and where the linkage has no motion.
    """
    return cast("Solve", import_module("analytic").solver(scene, channels))


def motion(scene: Scene, request: Request, channels: frozenset[str] | None = None) -> Motion:
    """Return the motion that `reference` has at the instants of a request."""
    return reference(scene, channels)(request.inputs(scene))


def _of_core(name: str) -> Callable[..., Any]:
    return lambda *arguments, **named: getattr(import_module("analytic"), name)(*arguments, **named)


# Functions of the analytic core, which is imported when one is called; they are documented there.
route: Callable[[Scene], str] = _of_core("route")
check_way: Callable[[Solve], None] = _of_core("check_way")
enclosures: Callable[..., Enclosures] = _of_core("enclose")
assemblies: Callable[..., Assemblies] = _of_core("assemblies")
in_closed_form: Callable[[Scene], bool] = _of_core("in_closed_form")
page_program: Callable[[Scene, Samples, Samples], Mapping[str, Any] | None] = _of_core("page_program")
many: Callable[[Scene, ByName, frozenset[str]], SolveMany] = _of_core("many_solver")
derivatives: Callable[[Scene, Sequence[str], Samples, Samples, frozenset[str]], ByName] = _of_core("derivatives")
sketch_fit: Callable[[Scene], SketchFit | None] = _of_core("sketch_fit")
stopped: Callable[[Scene, tuple[float, str] | None], MotionRange | None] = _of_core("stopped")


def tiers(name: str) -> Mapping[str, Settings]:
    """Return the settings that an engine offers by name, from the fastest to the most accurate."""
    module = engine(name)
    return dict(zip(TIERS, (module.FAST, module.DEFAULT, module.EXACT), strict=True))


def settings_of(name: str, *, full: bool) -> Mapping[Settings, str]:
    """Return all settings of an engine with the role of each; `full` adds those that only `--full` takes."""
    module = engine(name)
    if not full:
        return dict.fromkeys(module.WORK_PRECISION, WORK_PRECISION)
    settings = (*module.WORK_PRECISION, *module.LONG_WORK_PRECISION, *tiers(name).values())
    return dict.fromkeys(module.ABLATIONS, ABLATION) | dict.fromkeys(settings, WORK_PRECISION)
