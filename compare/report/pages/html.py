"""Pages from templates: what they are rendered in, their table of contents, and the figures packed at their end."""

import re
from base64 import b64encode
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from gzip import compress
from importlib.util import find_spec
from json import dumps
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import ChoiceLoader, Environment, FileSystemBytecodeCache, PackageLoader, StrictUndefined
from jinja2.bccache import Bucket
from markupsafe import Markup, escape

from ...engines.kept import environment
from ...judge.agreement import Word
from ...mechanics.axis import grouped
from ...mechanics.quantities import spelled
from ..figures.figure import MAX_POINTS
from ..numbers import percent, short

HERE, *OTHERS = (f"compare.report.{room}" for room in ("pages", "linkage", "bench", "figures"))  # that have templates
LEVEL = 6  # of compression
MAX_ROWS = 200  # of a table or a list
MARKS = {Word.agrees: "✓", Word.in_part: "≈", Word.disagrees: "✗", Word.not_solved: "✗"}


def render(name: str, package: str = HERE, *, most: int = MAX_POINTS, **values: Any) -> str:
    """A page from the template of a package, with at most so many points a curve of its figures."""
    return _templates(package).get_template(name).render(values, contents=[], figures=[], most=most)


class ByteCode(FileSystemBytecodeCache):
    """Compiled templates in files, where they can be written: compiling them anew takes a tenth of the main job."""

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Write one template; where that is impossible, it is compiled anew the next time."""
        with suppress(OSError):
            super().dump_bytecode(bucket)


@cache
def _templates(package: str) -> Environment:
    templates = Environment(
        loader=ChoiceLoader([PackageLoader(name, "") for name in dict.fromkeys((package, HERE, *OTHERS))]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        bytecode_cache=ByteCode(str(Path(__file__).with_name("__pycache__"))),
    )
    templates.filters |= {"table": shortened, "first": first, "percent": percent, "number": number, "cell": cell}
    templates.filters["grouped"] = grouped
    templates.filters["packed"] = lambda parts: packed(dumps(parts).encode())
    templates.globals |= {"versions_of": _versions, "library": _library, "marks": MARKS}
    return templates


def _versions(engines: Mapping[str, str]) -> list[dict[str, str]]:
    named = [*engines.items(), *environment().items()]
    return [{"environment": name, "version": version} for name, version in named]


@cache
def _library() -> str:
    """What draws the figures, without an import of its package, which needs a notebook's."""
    (folder,) = getattr(find_spec("uplot"), "submodule_search_locations", None) or ("",)
    return packed((Path(folder) / "static" / "uPlot.iife.js").read_bytes())


def packed(data: bytes) -> str:
    """What the script of a page unpacks: gzip in base64; the highest level takes twice as long for a per cent less."""
    return b64encode(compress(data, LEVEL, mtime=0)).decode()


def number(value: float, text: str, unit: str = "") -> Markup:
    """A number as text, with its value and unit for who points at it or takes it out of the page."""
    title = Markup(f' title="{value} {escape(spelled(unit))}"') if unit else ""
    return Markup(f'<data value="{value}"{title}>{escape(text)}</data>')


def cell(value: object) -> object:
    """What a cell of a table shows."""
    if value is None or value != value:
        return "–"
    return number(value, short(value)) if isinstance(value, float) else value


def shortened(
    table: Iterable[Mapping[Any, object]], worst: str = "", whole: str = "the JSON file"
) -> tuple[list[str], list[list[object]], str]:
    """Columns and rows of a table for a page, and in a sentence which rows of a long one are shown.

    Those with the largest numbers in the column `worst`, NaN as the largest, or the first ones; all are in `whole`.
    """
    rows, left_out = [*table], ""
    columns = dict.fromkeys(column for row in rows for column in row)
    if len(rows) > MAX_ROWS:
        chosen = f"with the largest {worst}" if worst else "that come first"
        left_out = f"The {MAX_ROWS} rows {chosen}, of {grouped(len(rows))}; all are in {whole}."
        size = np.array([row[worst] if worst else 0 for row in rows], float)
        rows = [rows[n] for n in np.argsort(-np.where(np.isnan(size), np.inf, size), kind="stable")[:MAX_ROWS]]
    return (
        [_header(str(column)) for column in columns],
        [[row.get(column) for column in columns] for row in rows],
        left_out,
    )


def _header(column: str) -> str:
    """The header of a column as a reader sees it, with the name of its unit: `inertia [kg mm²]`."""
    return re.sub(r"\[(.*)\]$", lambda unit: f"[{spelled(unit[1])}]", column)


def first(sentences: Iterable[str]) -> list[str]:
    """Sentences for a list; of very many the first."""
    written = [*sentences]
    more = (
        [f"And {grouped(len(written) - MAX_ROWS)} more, in the files beside this page."]
        if len(written) > MAX_ROWS
        else []
    )
    return written[:MAX_ROWS] + more
