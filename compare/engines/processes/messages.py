"""What a process with an engine sends: JSON, and after it the bytes of arrays of numbers.

    length of the JSON, 8 bytes | JSON, UTF-8 | bytes of the arrays, one after the other

In the JSON an array stands as `{"array": [type, shape, place]}`, its place in bytes behind the JSON. All else is as
JSON has it: None, truth values, numbers, texts, lists, and mappings from texts. Reading builds nothing else and calls
nothing, whoever wrote the message; an exception is raised for what is no such message. Its meaning is for the reader to
check. A pickle would be shorter here, and runs whatever its writer likes in the process that reads it.
"""

import json
import re
from typing import Any

import numpy as np

HEAD = 8  # bytes of the length
MAX_JSON = 2**22  # bytes; as Python's objects it takes twenty times as many
NUMBERS = "biufc"  # kinds of NumPy's types that are numbers
ARRAY = "array"


def written(value: Any) -> bytes:
    """Return a value as a message; TypeError where there is more in it than a message has."""
    arrays: list[bytes] = []
    place = 0

    def put(array: object) -> Any:
        nonlocal place
        if not (isinstance(array, np.ndarray) and array.dtype.kind in NUMBERS):
            raise TypeError(f"{type(array).__name__} is no data")
        arrays.append(array.tobytes())
        start, place = place, place + len(arrays[-1])
        return {ARRAY: [array.dtype.str, array.shape, start]}

    # Arrays are met by `default` in the order in which they are written; only their type, shape and place stand in the
    # JSON.
    text = json.dumps(value, default=put, separators=(",", ":")).encode("ascii")
    return b"".join([len(text).to_bytes(HEAD, "big"), text, *arrays])


def read(message: bytes) -> Any:
    """Return the value that was written, its tuples as lists, or raise whatever is wrong with the message."""
    start = HEAD + int.from_bytes(message[:HEAD], "big")
    if not HEAD <= start <= min(len(message), HEAD + MAX_JSON):
        raise ValueError("it is no message, or of too many names")

    def filled(found: dict[str, Any]) -> Any:
        if found.keys() != {ARRAY}:
            return found
        kind, shape, place = found[ARRAY]
        if not re.fullmatch(rf"[<>|][{NUMBERS}]\d{{1,2}}", kind) or not place >= 0:
            raise ValueError("an array in it is not one of numbers")
        # NumPy itself refuses a shape or place beyond the buffer. The copy is aligned and writable, and lets the
        # message go.
        return np.ndarray(tuple(shape), kind, message, start + place).copy()

    return json.loads(message[HEAD:start], object_hook=filled)
