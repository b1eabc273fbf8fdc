"""What tells a value or a function from others, by content: the same in every process, for names of files and the refusal of another sweep.

Numbers, texts, arrays and collections enter with all that is in them, other objects by what a pickle of them has. Functions enter by their
compiled code, with their default arguments, what they close over, and the global names in their code: values by content, functions and
classes in the same way. What comes with Python or is installed enters by its name alone. What has no such form is refused.
"""

from __future__ import annotations

import builtins
import copyreg
import dis
import functools
import hashlib
import importlib.util
import os
import site
import struct
import sys
import sysconfig
import types
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ..errors import InvalidInput

_ALLOWED = 'numbers, texts, arrays, collections of them, functions, objects that can be pickled; or version="..." of your own'
#: What a class or a module has of itself, and says nothing of what it does.
_BESIDES = frozenset(
    "__dict__ __weakref__ __doc__ __module__ __qualname__ __annotations__ __annotate__ __annotate_func__ __annotations_cache__ __firstlineno__"
    " __static_attributes__ __abstractmethods__ __subclasshook__ __orig_bases__ __parameters__ __type_params__".split()
)
_PACKAGE = __name__.partition(".")[0]


def of_value(name: str, value: Any, *, lenient: bool) -> str:
    """A short text for a value: itself where it is a number or a short text, else its type and hash."""
    if type(value) in (bool, int, float, type(None)) or (type(value) is str and len(value) <= 100):
        return repr(value)
    return f"{type(value).__name__} {_Content(name, '', lenient).digest(value)}"


def of_function(function: Any, *, lenient: bool) -> dict[str, Any]:
    """What tells a function from others, part by part, so that a refusal can say which part differs.

    With ``lenient`` what has no form enters by its type alone.
    """
    module = getattr(function, "__module__", None) or ""
    own = module.partition(".")[0]
    own = "" if own in sys.stdlib_module_names or own in sys.builtin_module_names or own == _PACKAGE else own
    if not isinstance(function, types.FunctionType):
        return {"object": _Content("function", own, lenient).digest(function)}
    parts: dict[str, Any] = {"code": _Content("code", own, lenient).digest(function.__code__)}
    for kind, values in _parts(function).items():
        hashes = {name: _Content(f"{kind} {name}", own, lenient).digest(value) for name, value in sorted(values.items())}
        if hashes:
            parts[kind] = hashes
    return parts


def difference(first: Any, second: Any, path: str = "") -> str:
    """Where two nested mappings of texts differ first, like ``function closure k``."""
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        for name in [*first, *(name for name in second if name not in first)]:
            if name not in first or name not in second:
                return f"{path} {name}".strip()
            inside = difference(first[name], second[name], f"{path} {name}".strip())
            if inside:
                return inside
        return ""
    return "" if first == second else path


class _Missing:
    """A variable or a name that has no value yet."""


def _parts(function: types.FunctionType) -> dict[str, dict[str, Any]]:
    """What a function depends on besides its code: default arguments, the variables it closes over, attributes, global names."""
    code = function.__code__
    given = function.__defaults__ or ()
    names = code.co_varnames[: code.co_argcount]
    defaults = dict(zip(names[len(names) - len(given) :], given, strict=True))
    closed: dict[str, Any] = {}
    for name, cell in zip(code.co_freevars, function.__closure__ or (), strict=True):
        try:
            closed[name] = cell.cell_contents
        except ValueError:
            closed[name] = _Missing
    return {
        "default": {**defaults, **(function.__kwdefaults__ or {})},
        "closure": closed,
        "attribute": dict(function.__dict__),
        "global": dict(_named(code, function.__globals__)),
    }


def _codes(code: types.CodeType) -> Iterator[types.CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from _codes(constant)


def _named(code: types.CodeType, names: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The global names in a code with their values. Of modules that are not installed, what is taken of them by name."""
    for one in _codes(code):
        path, value = "", None
        for instruction in dis.get_instructions(one):
            operation, name = instruction.opname, instruction.argval
            if operation in ("LOAD_ATTR", "LOAD_METHOD") and _is_own_module(value) and hasattr(value, name):
                path, value = f"{path}.{name}", getattr(value, name)
                continue
            if path:
                yield path, value
                path, value = "", None
            if operation in ("LOAD_GLOBAL", "LOAD_NAME"):
                if name in names:
                    path, value = name, names[name]
                elif not hasattr(builtins, name):
                    yield name, _Missing
            elif operation == "IMPORT_NAME":
                found = _imported(name, names)
                if found is not None:
                    yield f"import {name}", found
        if path:
            yield path, value


def _imported(name: str, names: Mapping[str, Any]) -> Any:
    """A module that a function imports, if it is there."""
    package = names.get("__package__") or ""
    if not name:
        return sys.modules.get(package)
    for asked in (name, f"{package}.{name}" if package else name):
        if asked in sys.modules:
            return sys.modules[asked]
        try:
            spec = importlib.util.find_spec(asked)
        except (ImportError, ValueError):
            continue
        if spec is not None:
            return _File(asked, spec.origin)
    return None


class _File:
    """A module that is not imported yet."""

    def __init__(self, name: str, path: str | None) -> None:
        self.name, self.path = name, path


@functools.cache
def _installed() -> tuple[str, ...]:
    paths = {sysconfig.get_paths()[key] for key in ("stdlib", "platstdlib", "purelib", "platlib")}
    paths |= {*site.getsitepackages(), site.getusersitepackages()}
    return tuple(os.path.realpath(path) + os.sep for path in paths)


@functools.cache
def _is_installed(module: str, path: str | None) -> bool:
    """Whether a module comes with Python or is installed: of it the name says all."""
    first = module.partition(".")[0]
    if first == _PACKAGE or first in sys.builtin_module_names:
        return True
    if path is None:
        return first in sys.stdlib_module_names
    return os.path.realpath(path).startswith(_installed())


def _is_own_module(value: Any) -> bool:
    return isinstance(value, types.ModuleType) and not _is_installed(value.__name__, getattr(value, "__file__", None))


class _Content:
    """Hashes of values: that of a value is made of those of what is in it."""

    def __init__(self, name: str, own: str, lenient: bool) -> None:
        self._name, self._own, self._lenient = name, own, lenient
        #: What is being hashed, by its place in memory, with how deep it is; and what has been, kept so that its place is not used again.
        self._open: dict[int, int] = {}
        self._done: dict[int, tuple[bytes, Any]] = {}

    def digest(self, value: Any) -> str:
        return self._of(value).hex()

    def _all(self, kind: str, *values: Any) -> bytes:
        return _hash(kind, *map(self._of, values))

    def _of(self, value: Any) -> bytes:
        kind = type(value)
        if value is None or value is Ellipsis or value is NotImplemented:
            return _hash(repr(value))
        if kind is bool or kind is int:
            return _hash(kind.__name__, str(value).encode())
        if kind is float:
            return _hash("float", struct.pack("<d", value))
        if kind is complex:
            return _hash("complex", struct.pack("<dd", value.real, value.imag))
        if kind is str:
            return _hash("str", value.encode("utf-8", "surrogatepass"))
        if kind is bytes or kind is bytearray:
            return _hash(kind.__name__, bytes(value))
        place = id(value)
        if place in self._open:
            return _hash("inside", str(len(self._open) - self._open[place]).encode())
        if place not in self._done:
            self._open[place] = len(self._open)
            found = self._compound(value)
            del self._open[place]
            self._done[place] = (found, value)
        return self._done[place][0]

    def _compound(self, value: Any) -> bytes:
        kind = type(value)
        if kind is list or kind is tuple:
            return self._all(kind.__name__, *value)
        if kind is dict or kind is types.MappingProxyType:
            return self._all("dict", *value.keys(), *value.values())
        if kind is set or kind is frozenset:
            return _hash(kind.__name__, *sorted(map(self._of, value)))
        if _is_array(value):
            return self._array(value)
        if isinstance(value, types.CodeType):
            return self._code(value)
        if isinstance(value, types.FunctionType):
            return self._function(value)
        if isinstance(value, types.MethodType):
            return self._all("method", value.__func__, value.__self__)
        if isinstance(value, (types.BuiltinFunctionType, types.MethodWrapperType)):
            owner = value.__self__
            return self._all("builtin", value.__qualname__, owner.__name__ if isinstance(owner, types.ModuleType) else owner)
        if isinstance(value, (staticmethod, classmethod)):
            return self._all(kind.__name__, value.__func__)
        if isinstance(value, property):
            return self._all("property", value.fget, value.fset, value.fdel)
        if isinstance(value, functools.cached_property):
            return self._all("cached_property", value.func)
        if isinstance(value, functools.partial):
            return self._all("partial", value.func, value.args, value.keywords)
        if isinstance(value, types.ModuleType):
            return self._module(value.__name__, getattr(value, "__file__", None))
        if isinstance(value, _File):
            return self._module(value.name, value.path)
        if isinstance(value, type):
            return self._class(value)
        if callable(value) and self._is_named(value):
            return self._all("named", value.__module__, value.__qualname__)
        wrapped = getattr(value, "__wrapped__", None)
        if callable(value) and callable(wrapped):
            # What keeps answers, and what is compiled: by what it stands for.
            return self._all("wrapped", kind, wrapped)
        return self._object(value)

    def _is_known(self, module: str | None) -> bool:
        """Whether what says that it is of this module enters by its name."""
        if not module or module in ("__main__", "__mp_main__") or module.partition(".")[0] == self._own:
            return False
        return _is_installed(module, getattr(sys.modules.get(module), "__file__", None))

    def _is_named(self, value: Any) -> bool:
        """Whether a function is what its name says in a module that enters by its name."""
        module, name = getattr(value, "__module__", None), getattr(value, "__qualname__", None)
        if not isinstance(module, str) or not isinstance(name, str) or not self._is_known(module):
            return False
        found: Any = sys.modules.get(module)
        for part in name.split("."):
            found = getattr(found, part, None)
        return found is value

    def _array(self, value: Any) -> bytes:
        import numpy as np

        if isinstance(value, np.ma.MaskedArray):
            mask = np.ma.getmaskarray(value)
            return self._all("masked", np.where(mask, np.zeros((), value.dtype), value.data), mask)
        values = np.asarray(value)
        kind, shape = values.dtype, values.shape
        if kind.hasobject or kind.char in "gGT":
            # Objects, texts, and numbers with unused bytes.
            return self._all("array", type(value).__name__, str(kind), shape, [repr(one) if kind.char in "gG" else one for one in values.ravel().tolist()])
        kind = kind.newbyteorder("<")
        described = kind.descr if kind.names else kind.str
        content = np.ascontiguousarray(values.astype(kind)).tobytes()
        return self._all("array", type(value).__name__, described, shape, content)

    def _code(self, code: types.CodeType) -> bytes:
        return self._all(
            "code",
            code.co_code,
            code.co_consts,
            code.co_names,
            code.co_varnames,
            code.co_freevars,
            code.co_cellvars,
            code.co_argcount,
            code.co_posonlyargcount,
            code.co_kwonlyargcount,
            # Not whether annotations were put off.
            code.co_flags & 0xFF,
        )

    def _function(self, function: types.FunctionType) -> bytes:
        if self._is_named(function):
            return self._all("named", function.__module__, function.__qualname__)
        parts = {kind: dict(sorted(values.items())) for kind, values in _parts(function).items()}
        return self._all("function", function.__code__, parts)

    def _module(self, name: str, path: str | None) -> bytes:
        if _is_installed(name, path) or path is None or not os.path.exists(path):
            return self._all("module", name)
        with open(path, "rb") as file:
            return self._all("module", name, file.read())

    def _class(self, kind: type) -> bytes:
        if kind.__module__ == "builtins" or self._is_known(kind.__module__):
            return self._all("named", kind.__module__, kind.__qualname__)
        entries = {
            name: None if isinstance(entry, (types.MemberDescriptorType, types.GetSetDescriptorType)) else entry
            for name, entry in sorted(vars(kind).items())
            if name not in _BESIDES and not name.startswith("_abc_")
        }
        return self._all("class", kind.__qualname__, kind.__bases__, type(kind), entries)

    def _object(self, value: Any) -> bytes:
        reduce: Callable[[Any], Any] | None = copyreg.dispatch_table.get(type(value))
        try:
            reduced = reduce(value) if reduce is not None else value.__reduce_ex__(4)
        except Exception as error:
            return self._without_form(value, error)
        if isinstance(reduced, str):
            return self._all("named", type(value), reduced)
        made, arguments, state, entries, pairs = (*reduced, None, None, None, None)[:5]
        listed = [None if more is None else list(more) for more in (entries, pairs)]
        return self._all("object", made, arguments, state, *listed)

    def _without_form(self, value: Any, error: Exception) -> bytes:
        if self._lenient:
            return self._all("unknown", type(value).__module__, type(value).__qualname__)
        raise InvalidInput(
            f"{self._name}: of a {type(value).__name__} in it cannot be told whether it is the same the next time ({error}); "
            f"allowed: {_ALLOWED}",
            key=self._name,
            value=type(value).__name__,
            allowed=_ALLOWED,
        ) from None


def _hash(kind: str, *parts: bytes) -> bytes:
    made = hashlib.sha256(f"{kind}:{len(parts)}:".encode())
    for part in parts:
        made.update(f"{len(part)}:".encode())
        made.update(part)
    return made.digest()


def _is_array(value: Any) -> bool:
    numpy = sys.modules.get("numpy")
    return numpy is not None and isinstance(value, (numpy.ndarray, numpy.generic))
