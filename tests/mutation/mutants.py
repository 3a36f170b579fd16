"""Mutants of a module: what decides, changed in one place.

A comparison at its limit and the other way round, a sign, an operator, a number, and for or,
least for most, any for all, a branch of `where`, a condition, a value that is returned, a
complaint that is not made. Words are left alone, and what is only said to a type checker.
"""

from __future__ import annotations

import ast
import copy
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType

COMPARED: dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
"""At its limit, and the other way round."""
OPERATED: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
CALLED = {"maximum": "minimum", "max": "min", "all": "any"}
CALLED |= {new: old for old, new in CALLED.items()}


@dataclass(frozen=True)
class Mutant:
    """One change: what it is called, where it is, and the module with it."""

    name: str
    function: str
    line: int
    tree: ast.Module

    def code(self, path: Path) -> CodeType:
        return compile(self.tree, str(path), "exec", dont_inherit=True)


def mutants(source: str) -> list[Mutant]:
    """Every mutant of a module, in the order of its lines."""
    tree = ast.parse(source)
    found: list[Mutant] = []
    names: Counter[str] = Counter()
    for place, function in _places(tree):
        node = _at(tree, place)
        for changed in _changed(node):
            whole = copy.deepcopy(tree)
            _put(whole, place, ast.copy_location(changed, node))
            ast.fix_missing_locations(whole)
            name = f"{function}: {_words(node)} -> {_words(changed)}"
            names[name] += 1
            if names[name] > 1:
                name += f" #{names[name]}"
            found.append(Mutant(name, function, node.lineno, whole))
    return found


def _words(node: ast.AST) -> str:
    return " ".join(ast.unparse(node).split())[:160] or "pass"


Place = tuple[tuple[str, int | None], ...]


def _places(tree: ast.Module) -> Iterator[tuple[Place, str]]:
    """Every node that counts, and the function that it is in."""

    def walk(node: ast.AST, place: Place, function: str) -> Iterator[tuple[Place, str]]:
        if isinstance(node, ast.expr | ast.stmt):
            yield place, function or "module"
        if isinstance(node, ast.Assert | ast.Import | ast.ImportFrom) or _shapes(node):
            return
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            function = f"{function}.{node.name}" if function else node.name
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "type_comment", "bases"):
                continue
            for k, one in enumerate(value) if isinstance(value, list) else [(None, value)]:
                if isinstance(one, ast.AST) and not _is_checking(one):
                    yield from walk(one, (*place, (field, k)), function)

    yield from walk(tree, (), "")


def _shapes(node: ast.AST) -> bool:
    """Whether it only says of what shape an array is."""
    return isinstance(node, ast.Call) and ast.unparse(node.func).endswith(".reshape")


def _is_checking(node: ast.AST) -> bool:
    """Whether it is for a type checker only."""
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def _at(node: ast.AST, place: Place) -> ast.AST:
    for field, k in place:
        value = getattr(node, field)
        node = value if k is None else value[k]
    return node


def _put(tree: ast.AST, place: Place, new: ast.AST) -> None:
    *above, (field, k) = place
    parent = _at(tree, tuple(above))
    if k is None:
        setattr(parent, field, new)
    else:
        getattr(parent, field)[k] = new


def _changed(node: ast.AST) -> Iterator[ast.AST]:
    """What may stand in the place of a node."""
    match node:
        case ast.Compare():
            for k, op in enumerate(node.ops):
                for other in COMPARED[type(op)]:
                    yield _with(node, ops=[*node.ops[:k], other(), *node.ops[k + 1 :]])
        case ast.BoolOp():
            yield _with(node, op=ast.Or() if isinstance(node.op, ast.And) else ast.And())
        case ast.UnaryOp():
            yield node.operand
        case ast.BinOp() if type(node.op) in OPERATED and not _of_words(node):
            yield _with(node, op=OPERATED[type(node.op)]())
        case ast.Constant(value=bool()):
            yield ast.Constant(not node.value)
        case ast.Constant(value=int() | float()):
            yield ast.Constant(node.value + 1)
        case ast.Call(func=ast.Attribute(attr="where"), args=[condition, yes, no]):
            yield _with(node, args=[condition, no, yes])
        case ast.Call(func=ast.Attribute(attr=name)) if name in CALLED:
            yield _with(node, func=_with(node.func, attr=CALLED[name]))
        case ast.Call(func=ast.Name(id=name)) if name in CALLED:
            yield _with(node, func=ast.Name(CALLED[name], ast.Load()))
        case ast.If() | ast.IfExp() | ast.While() if not isinstance(
            node.test, ast.Compare | ast.UnaryOp
        ):
            yield _with(node, test=ast.UnaryOp(ast.Not(), node.test))
        case ast.Return(value=ast.expr()) if ast.unparse(node.value) != "None":
            yield ast.Return(None)
        case ast.AugAssign():
            yield ast.Pass()
        case ast.Expr(value=ast.Call()):
            yield ast.Pass()
        case ast.Raise():
            yield ast.Pass()


def _with(node: ast.AST, **fields: object) -> ast.AST:
    """A copy with other fields."""
    new = copy.copy(node)
    for field, value in fields.items():
        setattr(new, field, value)
    return new


def _of_words(node: ast.BinOp) -> bool:
    """Whether words are put together."""
    return any(
        isinstance(one, ast.JoinedStr) or (isinstance(one, ast.Constant) and type(one.value) is str)
        for one in (node.left, node.right)
    )
