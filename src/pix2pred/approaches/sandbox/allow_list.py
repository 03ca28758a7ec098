"""The Python that a classifier may be written in: expressions, loops and functions over what it is given.

Imported by the confined process, where only the standard library exists. What is not listed is refused: imports,
classes, exceptions, ``with``, ``await``, format strings, names and attributes that begin with an underscore, and every
attribute but a few methods of lists, dictionaries, strings and ``math``.
"""

from __future__ import annotations

import ast

NODES: tuple[type[ast.AST], ...] = (
    ast.Module, ast.FunctionDef, ast.arguments, ast.arg, ast.Return, ast.Assign, ast.AugAssign, ast.Expr, ast.If,
    ast.For, ast.While, ast.Break, ast.Continue, ast.Pass, ast.BoolOp, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Call,
    ast.keyword, ast.IfExp, ast.Name, ast.Constant, ast.List, ast.Tuple, ast.Set, ast.Dict, ast.Subscript, ast.Slice,
    ast.Starred, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.comprehension, ast.Lambda,
    ast.Attribute, ast.operator, ast.unaryop, ast.boolop, ast.cmpop, ast.expr_context,
)  # fmt: skip

METHODS = frozenset((
    "get", "objects", "append", "add", "items", "keys", "values", "count", "index", "startswith", "endswith", "lower",
    "upper",
))  # fmt: skip

MATH = frozenset((
    "sqrt", "hypot", "floor", "ceil", "fabs", "isclose", "sin", "cos", "tan", "atan2", "acos", "asin", "pi", "inf",
    "dist",
))  # fmt: skip

BUILTINS = (
    "abs", "all", "any", "bool", "dict", "enumerate", "filter", "float", "int", "len", "list", "map", "max", "min",
    "range", "reversed", "round", "set", "sorted", "str", "sum", "tuple", "zip",
)  # fmt: skip

LONGEST = 20_000
"""Characters of a program."""


class RefusedError(ValueError):
    """A program outside the allowed language; the message names the line and what is not allowed there."""


def allowed(source: str) -> ast.Module:
    """Parse ``source`` and check every node. Raises ``RefusedError``, or ``SyntaxError`` for what is no Python."""
    if len(source) > LONGEST:
        raise RefusedError(f"longer than {LONGEST} characters")
    tree = ast.parse(source)
    for node in ast.walk(tree):
        _check(node)
    plain: ast.Module = ast.fix_missing_locations(_Plain().visit(tree))
    return plain


MAKE_SET, REMAINDER = "_set", "_remainder"
"""What sets and remainders are written as, so that no value depends on where in memory something lies.

Names that begin with an underscore are refused, so that a program can neither use nor replace these.
"""


class _Plain(ast.NodeTransformer):
    """Writes ``{a, b}`` as ``_set([a, b])`` and ``a % b``, which also formats text, as ``_remainder(a, b)``."""

    def visit_Set(self, node: ast.Set) -> ast.AST:
        self.generic_visit(node)
        return _call(node, MAKE_SET, ast.List(node.elts, ast.Load()))

    def visit_SetComp(self, node: ast.SetComp) -> ast.AST:
        self.generic_visit(node)
        return _call(node, MAKE_SET, ast.GeneratorExp(node.elt, node.generators))

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        return _call(node, REMAINDER, node.left, node.right) if isinstance(node.op, ast.Mod) else node

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.op, ast.Mod):
            return node
        if not isinstance(node.target, ast.Name):
            raise RefusedError(f"line {node.lineno}: %= is allowed for plain names alone")
        value = _call(node, REMAINDER, ast.Name(node.target.id, ast.Load()), node.value)
        return ast.copy_location(ast.Assign([node.target], value), node)


def _call(node: ast.AST, name: str, *arguments: ast.expr) -> ast.expr:
    return ast.copy_location(ast.Call(ast.Name(name, ast.Load()), list(arguments), []), node)


def _check(node: ast.AST) -> None:
    where = f"line {getattr(node, 'lineno', '?')}: "
    if not isinstance(node, NODES):
        raise RefusedError(f"{where}{type(node).__name__} is not allowed")
    if isinstance(node, ast.FunctionDef):
        if node.decorator_list:
            raise RefusedError(f"{where}decorators are not allowed")
        node.returns = None
        _check_name(where, node.name)
    elif isinstance(node, ast.arg):
        node.annotation = None  # evaluated when the function is defined, and of no use here
        _check_name(where, node.arg)
    elif isinstance(node, ast.keyword):
        _check_name(where, node.arg or "")
    elif isinstance(node, ast.Name):
        _check_name(where, node.id)
    elif isinstance(node, ast.Attribute) and node.attr not in METHODS:
        of_math = isinstance(node.value, ast.Name) and node.value.id == "math" and node.attr in MATH
        if not (of_math and isinstance(node.ctx, ast.Load)):
            raise RefusedError(f"{where}the attribute {node.attr!r} is not allowed")
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow | ast.LShift):
        power = node.right.value if isinstance(node.right, ast.Constant) else None
        if isinstance(node.op, ast.LShift) or power not in (0.5, 2, 3):
            raise RefusedError(f"{where}powers other than 0.5, 2 and 3, and shifts, are not allowed")
    elif isinstance(node, ast.Constant) and not isinstance(node.value, bool | int | float | str | None):
        raise RefusedError(f"{where}a constant of type {type(node.value).__name__} is not allowed")
    if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load):
        raise RefusedError(f"{where}attributes cannot be changed")


def _check_name(where: str, name: str) -> None:
    if name.startswith("_") or not name.isascii():
        raise RefusedError(f"{where}the name {name!r} is not allowed")
