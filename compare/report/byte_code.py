"""What takes long to make, kept where Python keeps the byte code of this package, as Python keeps it.

A file starts with a digest of what it was made from and of the rest, so that one that is old, or damaged, does not
count. Where Python writes no byte code, nothing is written; where a file cannot be written, the next run makes it anew.
"""

import sys
from contextlib import suppress
from hashlib import sha256
from importlib.machinery import SourceFileLoader
from importlib.util import cache_from_source
from pathlib import Path

DIGEST = sha256().digest_size


def read(name: str, made_from: bytes) -> bytes | None:
    """Return what is kept under a name, or None where that was made from anything else."""
    with suppress(OSError):
        kept = Path(_place(name)).read_bytes()
        if kept[:DIGEST] == _digest(made_from, kept[DIGEST:]):
            return kept[DIGEST:]
    return None


def write(name: str, made_from: bytes, data: bytes) -> None:
    """Keep data under a name: all of them or none, in silence."""
    if not sys.dont_write_bytecode:
        SourceFileLoader(__name__, __file__).set_data(_place(name), _digest(made_from, data) + data)


def _place(name: str) -> str:
    return cache_from_source(str(Path(__file__).with_name(f"{name}.py")))


def _digest(made_from: bytes, data: bytes) -> bytes:
    return sha256(sha256(made_from).digest() + data).digest()
