"""Every table and sentence, for the pages, the files and the terminal."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

TableRows: TypeAlias = Sequence[Mapping[str, object]]  # by column; each may lack some
