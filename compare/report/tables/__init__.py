"""Every table and sentence, for the pages, the files and the terminal."""

from collections.abc import Iterable
from typing import Any, TypeAlias

TableRows: TypeAlias = Iterable[dict[str, Any]]  # by column; each may lack some
