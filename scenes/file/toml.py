"""Reading of TOML files, whatever they are: what leaves is tables of a few levels and of numbers that fit a double."""

import re
import stat
import tomllib
from collections.abc import Mapping
from datetime import date, time
from numbers import Integral, Real
from pathlib import Path
from typing import Any

from ..arguments import refuse, shown
from ..errors import InputError, at_place, nearest, one_line, path_in_file
from ..limits import FILE_BYTES, INTEGER_BITS, KEY_PARTS, NESTING

_PART = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""  # of a key; each character is looked at once
_LONG_KEY = re.compile(rf"(?<![\w\\-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{KEY_PARTS}}}")
_KINDS = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFSOCK: "a socket"}


def read_toml(name_or_path: str | Path, known: Mapping[str, Path], kind: str) -> dict[str, Any]:
    """The tables of a file: one of the known by its name, any other by its path; InputError names its kind."""
    shown = one_line(str(name_or_path)) or "''"
    path = known.get(str(name_or_path), Path(name_or_path))
    with at_place(shown):
        try:
            text = read_text(path, FILE_BYTES)
            if _LONG_KEY.search(text):
                raise InputError(f"expected keys of {KEY_PARTS} parts at most, found one of more")
            tables = tomllib.loads(text)
        except FileNotFoundError:
            raise InputError(f"no such {kind} or file{nearest(path.stem, known)}") from None
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise InputError(f"not valid TOML: {str(error) or type(error).__name__}{_slip(text, error)}") from None
        except ValueError as error:  # an integer of thousands of digits
            raise InputError(f"cannot be read ({error})") from None
        return copied(tables)


def copied(tables: object) -> dict[str, Any]:
    """Tables as TOML gives them, which share nothing with these.

    Raises:
        InputError: they hold what no file does, are nested deeper than any file needs, or have an integer that TOML
            does not promise.
    """
    if not isinstance(tables, Mapping):
        refuse("tables", "tables by name, as tomllib.loads(...) returns them", tables)
    return dict(_copied(tables, ()))


_SLIPS = {  # what lines that cannot be read often have: what to write instead
    r"=\s*([-+]?\d+),(\d+)": r"a number's decimals come after a '.', as \1.\2",
    r"=\s*([-+]?[\d.]+) *[A-Za-z]": r"a number stands alone, as \1; its unit is in [units]",
    r"=\s*([A-Za-z]\w*)\s*(?:#.*)?$": r'a text needs quotation marks, as "\1"',
}


def _slip(text: str, error: Exception) -> str:
    """What to write in a line that cannot be read; nothing where no usual slip is in it."""
    where = re.search(r"at line (\d+)", str(error))
    line = text.split("\n")[int(where[1]) - 1] if where else ""
    found = ((re.search(pattern, line), instead) for pattern, instead in _SLIPS.items())
    return next((f"; {slip.expand(instead)}" for slip, instead in found if slip), "")


def read_text(path: Path, most: int) -> str:
    """What a text file in UTF-8, of so many bytes at most, holds; else InputError, or FileNotFoundError of none."""
    try:
        mode = path.stat().st_mode
        if not stat.S_ISREG(mode):
            raise InputError(f"expected a text file, found {_KINDS.get(stat.S_IFMT(mode), 'a device')}")
        with path.open("rb") as file:
            content = file.read(most + 1)
        if len(content) > most:
            raise InputError(f"expected a file of {most} bytes at most, found one of more")
        return content.decode("utf-8-sig")  # with the mark that some editors put first, or without
    except FileNotFoundError:
        raise
    except UnicodeDecodeError as error:
        raise InputError(f"expected a text file in UTF-8, and byte {error.start} is none") from None
    except (OSError, ValueError) as error:  # the latter of a zero in the path
        raise InputError(f"cannot be read ({getattr(error, 'strerror', error)})") from None


def _copied(value: object, place: tuple[object, ...]) -> Any:
    match value:
        case float():
            return float(value)
        case str() | bool() | date() | time():
            return value
        case Integral():
            if (number := int(value)).bit_length() > INTEGER_BITS:
                raise InputError(f"{path_in_file(place)}: expected an integer of {INTEGER_BITS} bits at most")
            return number
        case Real():
            return float(value)
        case Mapping() | list() | tuple():
            if len(place) > NESTING:
                raise InputError(f"{path_in_file(place)}: expected {NESTING} levels of tables and lists at most")
            if not isinstance(value, Mapping):
                return [_copied(child, (*place, number)) for number, child in enumerate(value)]
            if odd := [key for key in value if not isinstance(key, str)]:
                raise InputError(f"{path_in_file(place) or 'tables'}: expected texts as keys, found {shown(odd[0])}")
            return {str(key): _copied(child, (*place, key)) for key, child in value.items()}
    raise InputError(f"{path_in_file(place)}: expected what TOML has, found {shown(value)}")
