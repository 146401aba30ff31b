"""Pages from templates: what they are rendered in, their table of contents, and the figures packed at their end."""

from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from gzip import compress
from importlib.metadata import version
from importlib.resources import files
from itertools import islice
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jinja2 import BytecodeCache, ChoiceLoader, Environment, PackageLoader, StrictUndefined
from jinja2.bccache import Bucket
from markupsafe import Markup, escape

from ..engines.environment import environment
from . import byte_code, numbers
from .extremes import CURVE
from .figure import CONFIG, Figure, template

if TYPE_CHECKING:
    from pandas import DataFrame

HERE = "compare.report"  # the package of the templates that all pages share
ROWS = 200  # of a table or a list, at most
LEVEL = 5  # of the library's gzip: the page of three engines stays below 2.5 MB; level 6 takes 40 % longer


def render(name: str, package: str = HERE, *, most: int = CURVE, **values: Any) -> str:
    """Return a page.

    Args:
        name: of the template, a path in its package.
        package: that has it.
        most: points a curve of the page's figures.
        values: what the template uses.
    """
    return _templates(package).get_template(name).render(values, parts=Parts(most))


@cache
def _templates(package: str) -> Environment:
    packages = dict.fromkeys((package, HERE))
    templates = Environment(
        loader=ChoiceLoader([PackageLoader(package, "") for package in packages]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        bytecode_cache=_ByteCode(),
    )
    templates.filters |= {"table": shortened, "first": first, "percent": numbers.percent}
    templates.filters |= {"number": number, "cell": cell, "row": table_row}
    templates.filters["packed"] = lambda parts: packed(dumps(parts).encode())
    templates.globals |= {"environment": environment, "library": _library}
    return templates


class _ByteCode(BytecodeCache):
    """Templates as Python's byte code, made anew for another text of the template or of these filters."""

    def __init__(self) -> None:
        filters = (Path(file).read_bytes() for file in (__file__, numbers.__file__))  # constants went through them
        self._compiler = b"".join((version("jinja2").encode(), *filters))

    def load_bytecode(self, bucket: Bucket) -> None:
        """Take what is kept of a template."""
        if (code := byte_code.read(bucket.key, self._compiler + bucket.checksum.encode())) is not None:
            bucket.bytecode_from_string(code)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep a template."""
        byte_code.write(bucket.key, self._compiler + bucket.checksum.encode(), bucket.bytecode_to_string())


@cache
def _library() -> str:
    """Return plotly's script, packed; made anew where its size or time changed, as Python does with a source file."""
    script = Path(str(files("plotly") / "package_data/plotly.min.js"))
    made_from = f"{script.stat().st_size} {script.stat().st_mtime_ns} {LEVEL}".encode()
    if (kept := byte_code.read(script.name, made_from)) is None:
        byte_code.write(script.name, made_from, kept := packed(script.read_bytes(), LEVEL).encode())
    return kept.decode()


def packed(data: bytes, level: int = 9) -> str:
    """Return what the script of a page unpacks, as gzip in base64."""
    return b64encode(compress(data, level, mtime=0)).decode()


def number(value: float, text: str, unit: str = "") -> Markup:
    """Return a number as text, with its value and unit for who points at it or takes it out of the page."""
    title = Markup(f' title="{value} {escape(unit)}"') if unit else ""
    return Markup(f'<data value="{value}"{title}>{escape(text)}</data>')


def cell(value: object) -> object:
    """Return what a cell of a table shows."""
    if value is None or value != value:
        return "–"
    return number(value, numbers.short(value)) if isinstance(value, float) else value


class Parts:
    """What a page collects while it is rendered: its sections and its figures."""

    def __init__(self, most: int) -> None:
        self.contents: list[tuple[str, str]] = []  # anchor and title of every section
        self._most, self._figures = most, list[str]()

    def section(self, anchor: str, title: str) -> str:
        """Enter a section into the table of contents, and return its anchor."""
        self.contents.append((anchor, title))
        return anchor

    def figure(self, figure: Figure) -> int:
        """Take a figure in, and return its number."""
        self._figures.append(figure.json(self._most))
        return len(self._figures) - 1

    @property
    def figures(self) -> str:
        """All figures, and the look and the buttons that they share, packed; nothing where there are none."""
        shared = f'"template":{template()},"config":{dumps(CONFIG)}'
        text = f'{{{shared},"figures":[{",".join(self._figures)}]}}'
        return packed(text.encode()) if self._figures else ""


@dataclass(frozen=True)
class Table:
    """A table as shown: of a long one not all rows."""

    columns: Sequence[str]
    rows: Sequence[Sequence[object]]
    left_out: str  # which rows are shown, in a sentence


def shortened(
    table: "Sequence[Mapping[Any, object]] | DataFrame", worst: str = "", whole: str = "the JSON file"
) -> Table:
    """Return a table for a page; of a long one the first rows, or those with the largest numbers in a column.

    Args:
        table: rows, of which each may lack some columns, or a data frame.
        worst: name of that column; NaN is the largest.
        whole: where all rows are.
    """
    rows, left_out = table if isinstance(table, Sequence) else table.to_dict("records"), ""
    columns = dict.fromkeys(column for row in rows for column in row)
    if len(rows) > ROWS:
        which = f"with the largest {worst}" if worst else "that come first"
        left_out = f"The {ROWS} rows {which}, of {len(rows):,}; all are in {whole}."
        size = np.array([row[worst] if worst else 0 for row in rows], float)
        rows = [rows[n] for n in np.argsort(-np.where(np.isnan(size), np.inf, size), kind="stable")[:ROWS]]
    return Table([*map(str, columns)], [[row.get(column) for column in columns] for row in rows], left_out)


def table_row(values: Sequence[object]) -> Markup:
    """Return a row of a table, whose first cell names it."""
    name, *others = (escape(cell(value)) for value in values)
    return Markup(f'<tr><th scope="row">{name}</th>{"".join(f"<td>{other}</td>" for other in others)}</tr>')


def first(sentences: Iterable[str]) -> list[str]:
    """Return sentences for a list; of very many the first."""
    written = iter(sentences)
    shown = [*islice(written, ROWS)]
    more = sum(1 for _ in written)
    return [*shown, f"And {more:,} more, in the files beside this page."] if more else shown
