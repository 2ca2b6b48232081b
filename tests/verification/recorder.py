"""A plugin of pytest that records what the tests of the cases compare: ours, the answer, and the
error over the tolerance.

It reads the comparisons that tests make anyway: ``pytest.approx``, ``np.testing.assert_allclose``
and asserts of the form ``error < tolerance``. Only comparisons of a result with an answer count;
those of a closed form with its tabulated value do not (`reading.Test.compares_answers_alone`).
"""

import ast
import inspect
import linecache
import math
import operator
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.verification import reading

_NUMBER = r"-?\d[\d.]*(?:e[+-]?\d+)?"
_COMPARED = {ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge}
_SIGNS = {operator.lt: "<", operator.le: "<=", operator.gt: ">", operator.ge: ">="}
_BELOW = (operator.lt, operator.le)
_ARITHMETIC = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
_LARGEST = 0.1  # a larger bound is that of a quantity, not that of an error
_SCALAR = type(pytest.approx(1.0))  # what arrays and lists are compared by as well
_EXPLAINS = str(Path("_pytest", "assertion"))
_ERROR = re.compile(r"abs\(|error|norm\(|drift|checks\[|residual|allclose|miss")
_ORDERS = re.compile(r"(?:array\()?\[([^\[\]]+)\]\)? = \w*(?:slopes?|orders?)\(")


class Recorder:
    """``kept`` has an entry for each test function, by file and name: its cases, how many
    comparisons were made, the one nearest to its tolerance, orders and controls. With ``first``
    each test runs with its first parameters alone."""

    def __init__(self, first: bool = False) -> None:
        self.kept: dict[str, dict[str, Any]] = {}
        self._first = first
        self._test: reading.Test | None = None
        self._code: Any = None

    @pytest.hookimpl(trylast=True)  # when tests that are not asked for are gone
    def pytest_collection_modifyitems(self, items):
        """Leave the first parameters of each test where these were asked for."""
        if self._first:
            found: dict[str, pytest.Item] = {}
            for item in items:
                found.setdefault(item.nodeid.split("[")[0], item)
            items[:] = found.values()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item):
        """Listen while a test of a case runs."""
        known = reading.tests(Path(item.path)) if item.get_closest_marker("case") else {}
        self._test = known.get(getattr(item, "originalname", None) or item.name)
        if self._test is None:
            return (yield)
        self._code = _code(item.obj)
        self._entry()
        try:
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(_SCALAR, "__eq__", self._scalar(_SCALAR.__eq__))
                patch.setattr(np.testing, "assert_allclose", self._arrays())
                return (yield)
        finally:
            self._test = None

    def pytest_assertion_pass(self, item, lineno, orig, expl):
        """An assert has passed: bounds and orders of convergence in its explanation."""
        source = linecache.getline(str(item.path), lineno).strip()
        if self._test is None or not source.startswith("assert"):
            return
        for value, sign, bound in _bounds(expl.split("\n")[0]):
            if not sign(value, bound):
                continue  # one side of an "or"
            if self._test.is_control(lineno):
                self._control(f"{value:.3g} {_SIGNS[sign]} {bound:.3g}")
            elif sign in _BELOW and bound <= _LARGEST and value >= 0.0 and _ERROR.search(orig):
                self._compared(lineno, value, 0.0, bound)
        for values in _ORDERS.findall(expl):
            finest = float(re.findall(_NUMBER, values)[-1])
            orders = self._entry()["orders"]
            if finest not in orders and not self._test.is_control(lineno):
                orders.append(finest)

    def _scalar(self, original):
        def equal(approx, actual):
            found = original(approx, actual)
            line = self._line()
            if bool(found) and line is not None and _finite(actual) and _finite(approx.expected):
                self._compared(line, float(actual), float(approx.expected), float(approx.tolerance))
            return found

        return equal

    def _arrays(self):
        original = np.testing.assert_allclose

        def allclose(actual, desired, rtol=1e-7, atol=0.0, **options):
            original(actual, desired, rtol=rtol, atol=atol, **options)
            line = self._line()
            ours, answer = np.broadcast_arrays(
                np.asarray(actual, dtype=float), np.asarray(desired, dtype=float)
            )
            if line is None or not ours.size:
                return
            allowed = atol + rtol * np.abs(answer)
            with np.errstate(divide="ignore", invalid="ignore"):
                ratio = np.nan_to_num(np.abs(ours - answer) / allowed)
            worst = np.unravel_index(ratio.argmax(), ratio.shape)
            self._compared(line, float(ours[worst]), float(answer[worst]), float(allowed[worst]))

        return allclose

    def _line(self) -> int | None:
        """Line of the test function that is being executed; None outside, and where pytest compares
        once more to explain an assert."""
        frame = inspect.currentframe()
        while frame is not None and _EXPLAINS not in frame.f_code.co_filename:
            if frame.f_code is self._code:
                return frame.f_lineno
            frame = frame.f_back
        return None

    def _entry(self) -> dict[str, Any]:
        return self.kept.setdefault(
            f"{self._test.file}::{self._test.name}",
            {
                "cases": list(self._test.cases),
                "comparisons": 0,
                "worst": None,
                "orders": [],
                "controls": [],
            },
        )

    def _control(self, said: str) -> None:
        controls = self._entry()["controls"]
        if said not in controls and len(controls) < 3:
            controls.append(said)

    def _compared(self, line: int, ours: float, answer: float, allowed: float) -> None:
        if not (allowed > 0.0 and math.isfinite(allowed)):
            return
        if self._test.is_control(line):
            self._control(f"{ours:.4g} = {answer:.4g} ± {allowed:.2g}")
            return
        if self._test.compares_answers_alone(line):
            return
        entry, ratio = self._entry(), abs(ours - answer) / allowed
        entry["comparisons"] += 1
        if entry["worst"] is None or ratio > entry["worst"]["ratio"]:
            entry["worst"] = {"ours": ours, "answer": answer, "allowed": allowed, "ratio": ratio}


def _bounds(said: str) -> Iterator[tuple[float, Callable, float]]:
    """Every comparison of two numbers in an explanation such as ``3e-13 < (1e-12 * 4.0)``."""
    try:
        tree = ast.parse(said, mode="eval")
    except SyntaxError:  # shortened, or with values that are no Python
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in _COMPARED:
            left, right = _value(node.left), _value(node.comparators[0])
            if left is not None and right is not None:
                yield left, _COMPARED[type(node.ops[0])], right


def _value(node: ast.expr) -> float | None:
    """The number that an expression of numbers has; None for any other expression."""
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return float(node.value)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        inner = _value(node.operand)
        return None if inner is None else -inner
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "np.float64":
        return _value(node.args[0])
    if isinstance(node, ast.BinOp) and type(node.op) in _ARITHMETIC:
        left, right = _value(node.left), _value(node.right)
        if left is not None and right is not None:
            return float(_ARITHMETIC[type(node.op)](left, right))
    return None


def _code(test) -> Any:
    """The code of a test function, that of a property test inside its wrapper."""
    inner = getattr(getattr(test, "hypothesis", None), "inner_test", test)
    return getattr(inner, "__func__", inner).__code__


def _finite(value) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and math.isfinite(value)
