"""Numbers packed into a page: the reference's to nine digits, an engine's as what they are off them."""

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..html import packed

Table = NDArray[np.float64]
WHOLE = 2**28  # what the largest number of a row of the reference is rounded to


def packed_motion(header: dict[str, Any], reference: Table, others: Sequence[Table]) -> str:
    """Return a text that a script unpacks, gzip in base64: a line of JSON, then numbers of four bytes, row by row.

    First bytes come first, then the second ones, and so on, which halves what gzip leaves.

    Args:
        header: what the JSON has, besides `quanta`: by row of the reference what its whole numbers count.
        reference: finite, shape (channels, n); kept as second differences of whole numbers.
        others: of any shape, in single precision.
    """
    quanta = np.maximum(np.abs(reference).max(axis=1), 1e-300) / WHOLE
    whole = np.round(reference / quanta[:, np.newaxis]).astype("<i4")
    second = np.diff(whole, 2, axis=1, prepend=np.zeros((len(whole), 2), "<i4"))
    with np.errstate(over="ignore"):
        tables = [second, *(other.astype("<f4") for other in others)]
    words = np.concatenate([np.ascontiguousarray(table).view(np.uint8).reshape(-1, 4) for table in tables])
    line = json.dumps(header | {"quanta": quanta.tolist()}, separators=(",", ":")).encode()
    return packed(line + b"\n" + words.T.tobytes())
