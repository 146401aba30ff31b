"""The machines that a workshop makes of one drawing: numbers of the scene drawn from its variations."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from scenes import InputError, Scene, load, numbers_in
from scenes.motion import Samples

if TYPE_CHECKING:
    from scipy.stats.qmc import Sobol

BITS = 30  # of the draws, before they become numbers
FAR = 2  # times `plus_minus`: six standard deviations, beyond all that is drawn


def check_ends(scene: Scene) -> None:
    """Look whether a linkage is still a scene where one of its numbers is as far off as any is drawn.

    Raises:
        InputError: it is not, or nothing varies.
    """
    if not scene.variations:
        raise InputError(f"{scene.file}: variations: missing; --monte-carlo draws machines from them")
    nominal = numbers_in(scene.file, [variation.path for variation in scene.variations])
    for variation, number in zip(scene.variations, nominal, strict=True):
        far = variation.plus_minus * (FAR if variation.distribution == "normal" else 1)
        for end in (number - far, number + far):
            load(scene.file, {variation.path: end})


def draws(scene: Scene, seed: int, first: int, count: int) -> Mapping[str, Samples]:
    """Return the numbers of some machines, by path, each of shape (count,), in the units of the file.

    A machine is the same whatever others are asked for: the points are those of a scrambled Sobol sequence, which fill
    the space of the variations more evenly than independent ones.

    Args:
        scene: with its variations.
        seed: of the scrambling.
        first: the number of the first machine, from 0.
        count: of machines.
    """
    from scipy.special import ndtri  # late: slow to import

    paths = [variation.path for variation in scene.variations]
    sequence = _sobol(len(paths), seed)
    if first:
        sequence.fast_forward(first)
    shares = sequence.random(_power_of_two(count))[:count] + 2.0 ** -(BITS + 1)  # the middle of its last place: no 0
    found = {}
    for variation, nominal, share in zip(scene.variations, numbers_in(scene.file, paths), shares.T, strict=True):
        of_deviations = ndtri(share) if variation.distribution == "normal" else (2 * share - 1) * 3**0.5
        found[variation.path] = nominal + variation.deviation * of_deviations
    return found


def _sobol(dimensions: int, seed: int) -> "Sobol":
    from scipy.stats.qmc import Sobol

    return Sobol(dimensions, scramble=True, bits=BITS, rng=seed)


def _power_of_two(count: int) -> int:
    """Return the next power of two, by which the sequence is to be asked."""
    return 1 << max(count - 1, 0).bit_length()
