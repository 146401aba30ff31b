"""What a run will cost, in time and memory, before it is made: shown where it is much, refused where it cannot be."""

import os
import sys
from collections.abc import Mapping, Sequence

from scenes import InputError, Sampling, Scene

from ..mechanics.axis import grouped

# By `python -m benchmarks.sizes` on one core of 3 GHz: the toggle press at up to 360,000 samples, chains of up to 51
# bodies. A number is one channel at one sample; those of an engine count with their errors, checks and files.
FIXED = 4.0  # s, of settings that are timed and of the page
MEMBER = 0.1  # s, of a member of a family besides
OF_BODIES = 0.004  # s, times the square of their number: of the same, and of the certificate
MATRIX = 2e-9  # s, times the cube of the constraints, for every sample of an engine
NUMBER: Mapping[str, float] = {"analytic": 3e-6, "exudyn": 6e-6, "pymunk": 8e-6, "multiprecision": 1e-4}  # s
OTHER = 1e-5  # s, of an engine that is not measured
PROGRAM, SQUARE = 200e6, 0.15e6  # bytes; those times the square of the bodies
SHARED, OWN = 90, 25  # bytes for every number: of the reference and what is being compared, and of each engine

SHOWN_S, SHOWN_BYTES = 30.0, 1e9  # above which a prediction is shown


def predicted(scene: Scene, sampling: Sampling, engines: Sequence[str], members: int = 0) -> tuple[float, float]:
    """What a run, or a family of so many members, costs without `--full`: s of processor time, and bytes."""
    bodies, numbers = len(scene.bodies), sampling.count * len(sampling.wanted(scene))
    # Dense factorisations of three coordinates a body dominate with many bodies (cubic); everything else goes with the
    # numbers that are returned (linear), the certificate with the bodies squared.
    matrices = MATRIX * (3 * bodies) ** 3 * sampling.count * len(engines)
    of_engines = numbers * sum(NUMBER.get(engine, OTHER) for engine in engines)
    seconds, memory = OF_BODIES * bodies**2 + matrices + of_engines, numbers * (SHARED + OWN * len(engines))
    program = PROGRAM + SQUARE * bodies**2
    if members:
        return members * (MEMBER + seconds), program + members * memory
    return FIXED + seconds, program + memory


def announce(scene: Scene, sampling: Sampling, engines: Sequence[str], members: int = 0) -> None:
    """Write one line to stderr on what a large run will cost, or raise InputError where no memory holds it."""
    (seconds, memory), limit = predicted(scene, sampling, engines, members), _memory()
    family = f" and {grouped(members)} members" if members else ""
    what = f"{grouped(sampling.count)} samples of {len(scene.bodies)} bodies by {len(engines)} engines{family}"
    if memory > limit:
        why = f"expected what fits into the {limit / 1e9:.1f} GB of memory here"
        raise InputError(f"{scene.name}: {why}; {what} need about {memory / 1e9:.1f} GB")
    if seconds > SHOWN_S or memory > SHOWN_BYTES:
        time = f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"
        print(f"{scene.name}: about {time} and {memory / 1e9:.1f} GB expected for {what}", file=sys.stderr)


def _memory() -> float:
    """The memory that this process may have, bytes."""
    try:
        import resource
    except ImportError:  # on Windows
        return float("inf")
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    machine = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return float(machine if limit == resource.RLIM_INFINITY else min(limit, machine))
