"""One wrong line in a module: an operator, a sign, a comparison, a constant, a condition, put in place at run time."""

import ast
from collections.abc import Iterator
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from inspect import getsource, unwrap
from types import CodeType, FunctionType
from typing import Any, TypeVar

Item = TypeVar("Item")


def _both_ways(*pairs: tuple[Item, Item]) -> dict[Item, Item]:
    return dict(pairs) | {second: first for first, second in pairs}


OPERATORS: dict[type[ast.operator], type[ast.operator]] = _both_ways((ast.Add, ast.Sub), (ast.Mult, ast.Div))
COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = _both_ways(
    *((ast.Lt, ast.Gt), (ast.LtE, ast.GtE), (ast.Eq, ast.NotEq), (ast.In, ast.NotIn), (ast.Is, ast.IsNot))
)
NAMES = _both_ways(("max", "min"), ("real", "imag"), ("sin", "cos"), ("all", "any"))
NAMES |= _both_ways(("maximum", "minimum"), ("argmax", "argmin"))
LARGER, MUCH_LARGER = 1e3, 1e6  # times a constant, and what a function returns
NUMBERS = ("float", "Samples")


@dataclass(frozen=True)
class Mutant:
    """A function with one wrong line."""

    module: str
    function: str  # as `Class.method`
    number: int  # of the change, among all of the module
    kind: str
    line: str


@contextmanager
def applied(mutant: Mutant) -> Iterator[None]:
    """Have a function with its wrong line in place, wherever it is called from."""
    function = _function(mutant.module, mutant.function)
    right = function.__code__
    function.__code__ = _code(mutant)
    try:
        yield
    finally:
        function.__code__ = right


def mutants(module: str, functions: tuple[str, ...] = ()) -> list[Mutant]:
    """Return every mutant of a module, or of some functions of it."""
    tree = ast.parse(getsource(import_module(module)))
    lines = ast.unparse(tree).splitlines()
    found = []
    for number, (name, node, kind, _) in enumerate(_changes(ast.parse("\n".join(lines)))):
        if (not functions or name in functions) and _replaceable(module, name):
            found.append(Mutant(module, name, number, kind, lines[node.lineno - 1].strip()))
    missing = set(functions) - {mutant.function for mutant in found}
    assert not missing, f"{module} has no {missing}, or nothing in it to change"
    return found


def _changes(tree: ast.Module) -> Iterator[tuple[str, Any, str, ast.AST]]:
    """Yield every change: the function, what is replaced, the kind of the change, and what takes its place."""
    for name, function in _functions(tree, ""):
        for statement in function.body:
            for node in ast.walk(statement):
                yield from ((name, node, kind, other) for kind, other in _others(node))
                if isinstance(node, ast.Return) and ast.unparse(function.returns or ast.Constant("")) in NUMBERS:
                    assert node.value is not None
                    yield name, node.value, "result", ast.BinOp(node.value, ast.Mult(), ast.Constant(MUCH_LARGER))


def _functions(node: ast.AST, prefix: str) -> Iterator[tuple[str, ast.FunctionDef]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef):
            yield f"{prefix}{child.name}", child
        elif isinstance(child, ast.ClassDef):
            yield from _functions(child, f"{prefix}{child.name}.")


def _others(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield what may stand in place of a node by mistake."""
    match node:
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS and not _is_text(left, right):
            yield "operator", ast.BinOp(left, OPERATORS[type(op)](), right)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield "sign dropped", operand
        case ast.Compare(left=left, ops=[op], comparators=right) if type(op) in COMPARISONS:
            yield "comparison", ast.Compare(left, [COMPARISONS[type(op)]()], right)
        case ast.Constant(value=bool(value)):
            yield "constant", ast.Constant(not value)
        case ast.Constant(value=int(value)):
            yield "constant", ast.Constant(value + 1)
        case ast.Constant(value=float(value)) if value:
            yield "constant", ast.Constant(LARGER * value)
        case ast.If(test=test, body=body, orelse=orelse):
            yield "condition", ast.If(ast.UnaryOp(ast.Not(), test), body, orelse)
        case ast.IfExp(test=test, body=chosen, orelse=other):
            yield "condition", ast.IfExp(ast.UnaryOp(ast.Not(), test), chosen, other)
        case (
            ast.Call(func=ast.Attribute(attr="abs"), args=[argument])
            | ast.Call(func=ast.Name(id="abs"), args=[argument])
        ):
            yield "abs dropped", argument
        case ast.Subscript(value=value, slice=ast.Call(), ctx=ast.Load()):
            yield "row", ast.Subscript(value, ast.Constant(0), ast.Load())
        case ast.Attribute(value=value, attr=attr, ctx=ast.Load()) if attr in NAMES:
            yield "name", ast.Attribute(value, NAMES[attr], ast.Load())
        case ast.Name(id=name, ctx=ast.Load()) if name in NAMES:
            yield "name", ast.Name(NAMES[name], ast.Load())


def _is_text(*operands: ast.expr) -> bool:
    """Return whether an operand is text or a list of things."""
    kinds = ast.JoinedStr | ast.List | ast.Tuple | ast.ListComp | ast.Set | ast.Dict
    return any(
        isinstance(one, kinds) or (isinstance(one, ast.Constant) and isinstance(one.value, str)) for one in operands
    )


class _Replacing(ast.NodeTransformer):
    def __init__(self, old: ast.AST, new: ast.AST) -> None:
        self.old, self.new = old, new

    def visit(self, node: ast.AST) -> Any:
        """Return the other node in place of the one."""
        return ast.copy_location(deepcopy(self.new), node) if node is self.old else self.generic_visit(node)


def _code(mutant: Mutant) -> CodeType:
    """Return the code of a function with its wrong line."""
    tree = ast.parse(ast.unparse(ast.parse(getsource(import_module(mutant.module)))))
    _, node, _, other = [*_changes(tree)][mutant.number]
    wrong = ast.fix_missing_locations(_Replacing(node, other).visit(tree))
    found = _codes(compile(wrong, f"<{mutant.module}>", "exec"))
    return next(code for code in found if code.co_qualname == mutant.function)


def _codes(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _codes(constant)


def _function(module: str, name: str) -> FunctionType:
    """Return a function, also one behind a property or a decorator."""
    found: Any = import_module(module)
    for part in name.split("."):
        found = vars(found)[part]
    if isinstance(found, property):
        found = found.fget
    if isinstance(found, cached_property):
        found = found.func
    found = unwrap(getattr(found, "__func__", found))
    assert isinstance(found, FunctionType)
    return found


def _replaceable(module: str, name: str) -> bool:
    """Return whether a function's code can be replaced: it is Python, and closes over nothing."""
    try:
        return not _function(module, name).__code__.co_freevars
    except (AssertionError, KeyError):
        return False
