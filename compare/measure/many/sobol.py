"""Sobol's points, which fill a cube more evenly than independent ones: a page takes them too, without SciPy's import.

The direction numbers are those of S. Joe and F. Y. Kuo, SIAM J. Sci. Comput. 30 (2008) 2635, doi:10.1137/070709359.
"""

import numpy as np
from numpy.typing import NDArray

from scenes.model.motion import Samples

BITS = 30
# Of every dimension but the first: the primitive polynomial, as bits, and as many first numbers as its degree.
NUMBERS = """
3:1 7:1,3 11:1,3,1 13:1,1,1 19:1,1,3,3 25:1,3,5,13 37:1,1,5,5,17 41:1,1,5,5,5 47:1,1,7,11,19 55:1,1,5,1,1
59:1,1,1,3,11 61:1,3,5,5,31 67:1,3,3,9,7,49 91:1,1,1,15,21,21 97:1,3,1,13,27,49 103:1,1,1,15,7,5
109:1,3,1,15,13,25 115:1,1,5,5,19,61 131:1,3,7,11,23,15,103 137:1,3,7,13,13,15,69 143:1,1,3,13,7,35,63
145:1,3,5,9,1,25,53 157:1,3,1,13,9,35,107 167:1,3,1,5,27,61,31 171:1,1,5,11,19,41,61 185:1,3,5,3,3,13,69
191:1,1,7,13,1,19,1 193:1,3,7,5,13,19,59 203:1,1,3,9,25,29,41 211:1,3,5,13,23,1,55 213:1,3,7,3,13,59,17
229:1,3,1,3,5,53,69 239:1,1,5,5,23,33,13 241:1,1,7,7,1,61,123 247:1,1,7,9,13,61,49 253:1,3,3,5,3,55,33
285:1,3,1,15,31,13,49,245 299:1,3,5,15,31,59,63,97 301:1,3,1,11,11,11,77,249
"""


# A point is the exclusive or of the direction numbers of the bits that are set in its number's Gray code (Antonov and
# Saleev 1979), here for all points at once. The sequence is scrambled by a random lower triangular matrix on the digits
# and a random shift (Matousek 1998), both from the seed, so that seeds give independent estimates. Evenness is best for
# powers of two of points; more than 40 dimensions get independent points.
def points(dimensions: int, seed: int, first: int, count: int) -> Samples:
    """The points `first` and so on of a sequence that its seed scrambles, shape (count, dimensions), between 0 and 1.

    A point is the same whatever others are asked for. Dimensions beyond the table's are of independent points.
    """
    random = np.random.default_rng(seed)
    directions = _scrambled(_directions()[:dimensions], random)
    shift = random.integers(1 << BITS, size=len(directions))
    number = np.arange(first, first + count)
    gray = number ^ number >> 1
    whole = np.tile(shift, (count, 1))
    for bit in range(BITS):
        whole ^= np.where(gray >> bit & 1, directions[:, bit, np.newaxis], 0).T
    even = (whole + 0.5) / (1 << BITS)  # the middle of the last place: no 0
    independent = random.random((first + count, dimensions - len(directions)))[first:]
    return np.hstack([even, independent])


def _scrambled(directions: NDArray[np.int64], random: np.random.Generator) -> NDArray[np.int64]:
    """Each digit with some of those before it added, modulo 2: the points are as even, and not on one lattice."""
    places = np.arange(BITS)[::-1]
    digits = directions[..., np.newaxis] >> places & 1
    mixing = np.tril(random.integers(2, size=(len(directions), BITS, BITS)), -1) + np.eye(BITS, dtype=np.int64)
    return np.asarray((np.einsum("dab,dnb->dna", mixing, digits) % 2 << places).sum(axis=-1))


def _directions() -> NDArray[np.int64]:
    """By dimension and bit of a point's Gray code, what is added to the point, modulo 2."""
    table = [[1 << bit for bit in reversed(range(BITS))]]
    for polynomial, code in (part.split(":") for part in NUMBERS.split()):
        m, coefficients = [int(number) for number in code.split(",")], f"{int(polynomial):b}"[1:]
        degree = len(m)
        # The recurrence of the primitive polynomial over GF(2): m_n = 2 a_1 m_(n-1) ^ ... ^ 2^d m_(n-d) ^ m_(n-d).
        for n in range(degree, BITS):
            m.append(m[n - degree] ^ m[n - degree] << degree)
            for k, coefficient in enumerate(coefficients[:-1], start=1):
                m[n] ^= int(coefficient) * m[n - k] << k
        table.append([number << BITS - 1 - bit for bit, number in enumerate(m)])
    return np.array(table)
