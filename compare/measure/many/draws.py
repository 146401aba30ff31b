"""The machines that a workshop makes of one drawing: numbers of the scene drawn from its variations."""

from collections.abc import Mapping

from scipy.special import ndtri

from scenes import Scene, numbers_in
from scenes.model.motion import Samples

BITS = 30  # of the draws, before they become numbers


def draws(scene: Scene, seed: int, first: int, count: int) -> Mapping[str, Samples]:
    """The numbers of some machines, by path, each of shape (count,), in the units of the file.

    A machine is the same whatever others are asked for: the points are those of a scrambled Sobol sequence, which fill
    the space of the variations more evenly than independent ones.

    Args:
        scene: with its variations.
        seed: of the scrambling.
        first: the number of the first machine, from 0.
        count: of machines.
    """
    from scipy.stats.qmc import Sobol  # which takes longer than all else that is imported

    paths = [variation.path for variation in scene.variations]
    sequence = Sobol(len(paths), scramble=True, bits=BITS, rng=seed)
    if first:
        sequence.fast_forward(first)
    shares = sequence.random(_power_of_two(count))[:count] + 2.0 ** -(BITS + 1)  # the middle of its last place: no 0
    drawn = {}
    for variation, nominal, share in zip(scene.variations, numbers_in(scene.file, paths), shares.T, strict=True):
        of_deviations = ndtri(share) if variation.distribution == "normal" else (2 * share - 1) * 3**0.5
        drawn[variation.path] = nominal + variation.deviation * of_deviations
    return drawn


def _power_of_two(count: int) -> int:
    """The next power of two, by which the sequence is to be asked."""
    return 1 << max(count - 1, 0).bit_length()
