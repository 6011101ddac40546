"""Writes the type stubs of the compiled module, from what its docstrings say of every signature.

    write_stubs.py FOLDER OUTPUT    FOLDER has the package `graticule`

Run by the build: stubs cannot disagree with what was built.
"""

import inspect
import re
import sys
import textwrap
from types import ModuleType
from typing import Any, Iterator, List, Optional, Tuple

HEAD = '''"""Factor graphs as data, solved by Ceres: what is compiled.  Written by write_stubs.py."""

from typing import (
    Any, Callable, ClassVar, Dict, List, Mapping, Optional, Sequence, Tuple, Union, overload
)

import numpy
from numpy.typing import ArrayLike, NDArray

class _Pybind11Type(type): ...

_KeyLike = Union["Key", str]
_NoiseLike = Union["Noise", float, ArrayLike]
'''

# Methods that every class has anyway, or that only pickling and printing call.
PASSED_OVER = {"__repr__", "__str__", "__getstate__", "__setstate__", "__init_subclass__"}


def translated(text: str, is_argument: bool) -> str:
    """A type as pybind11 spells it, as typing does."""
    text = text.replace("graticule._graticule.", "")
    array = r"numpy\.ndarray\[([\w.]+)\]"
    if is_argument:
        text = re.sub(array, "ArrayLike", text)
        text = re.sub(r"\bList\[", "Sequence[", text)
        text = re.sub(r"\bDict\[", "Mapping[", text)
        text = re.sub(r"\bKey\b", "_KeyLike", text)
        text = re.sub(r"\bNoise\b", "_NoiseLike", text)
    else:
        text = re.sub(array, lambda m: f"NDArray[{m[1].replace('bool', 'numpy.bool_')}]", text)
    text = re.sub(r"\bfunction\b", "Callable[..., Any]", text)
    text = re.sub(r"\bnumpy\.ndarray\b(?!\[)", "NDArray[Any]", text)
    return re.sub(r"\bdict\b", "Dict[str, Any]", text)


def split(arguments: str) -> List[str]:
    """Arguments, parted at commas that are not within brackets."""
    parts, depth, begin = [], 0, 0
    for i, letter in enumerate(arguments):
        depth += (letter in "([{<") - (letter in ")]}>" and arguments[i - 1 : i + 1] != "->")
        if letter == "," and depth == 0:
            parts.append(arguments[begin:i].strip())
            begin = i + 1
    return [part for part in parts + [arguments[begin:].strip()] if part]


def argument(text: str) -> str:
    if text == "**kwargs" or text == "*args":
        return text + ": Any"
    if ":" not in text:
        return text
    name, rest = text.split(":", 1)
    kind, is_optional, _ = rest.partition(" = ")
    if is_optional and "= None" in rest and "Optional" not in kind and kind.strip() != "object":
        kind = f"Optional[{kind.strip()}]"
    return f"{name}: {translated(kind.strip(), True)}" + (" = ..." if is_optional else "")


def signatures(doc: str, name: str) -> Iterator[Tuple[str, str, str]]:
    """Arguments, what is returned, and the text, of each overload."""
    starts = list(re.finditer(rf"^(?:\d+\. )?{re.escape(name)}\(", doc, re.M))
    if "Overloaded function." in doc:
        starts = [start for start in starts if start[0][0].isdigit()]
    for at, start in enumerate(starts):
        end = starts[at + 1].start() if at + 1 < len(starts) else len(doc)
        line, _, text = doc[start.end() : end].partition("\n")
        arguments, _, result = line.rpartition(") -> ")
        yield arguments, result, text.strip()


def quoted(text: str, indent: str) -> List[str]:
    if not text:
        return []
    lines = "\n\n".join(
        textwrap.fill(part, 92 - len(indent)) for part in text.split("\n\n")
    ).split("\n")
    lines[0] = '"""' + lines[0]
    if lines[-1].endswith('"'):
        lines[-1] = lines[-1][:-1] + '\\"'
    lines[-1] += '"""'
    return [(indent + line).rstrip() for line in lines]


def function(name: str, doc: str, indent: str, fields: Optional[List[str]] = None,
             is_static: bool = False) -> List[str]:
    lines: List[str] = []
    overloads = list(signatures(doc, name))
    for arguments, result, text in overloads:
        parts = [argument(part) for part in split(arguments)]
        if indent and not is_static and parts:
            parts[0] = "self"
        if name == "__eq__":
            parts[1:] = ["other: object"]
        if name == "__init__" and fields is not None and parts[-1] == "**kwargs: Any":
            parts = ["self", *(["*", *fields] if fields else [])]
        if len(overloads) > 1:
            lines.append(indent + "@overload")
        if is_static:
            lines.append(indent + "@staticmethod")
        body = quoted(text, indent + "    ")
        lines.append(f"{indent}def {name}({', '.join(parts)}) -> {translated(result, False)}:"
                     + ("" if body else " ..."))
        lines += body
    return lines


def enumeration(kind: type) -> List[str]:
    name = kind.__name__
    lines = [f"    {member}: ClassVar[{name}]" for member in kind.__members__]  # type: ignore
    return lines + [
        f"    __members__: ClassVar[Dict[str, {name}]]",
        "    def __init__(self, value: int) -> None: ...",
        "    def __eq__(self, other: object) -> bool: ...",
        "    def __ne__(self, other: object) -> bool: ...",
        "    def __hash__(self) -> int: ...",
        "    def __int__(self) -> int: ...",
        "    def __index__(self) -> int: ...",
        "    @property",
        "    def name(self) -> str: ...",
        "    @property",
        "    def value(self) -> int: ...",
    ]


def members(kind: type) -> List[str]:
    lines: List[str] = []
    fields: List[str] = []
    methods = []
    for name, member in vars(kind).items():
        if isinstance(member, property):
            found = re.search(r"-> (.*)$", member.fget.__doc__.strip().splitlines()[0])
            assert found, (kind, name, member.fget.__doc__)
            lines += ["    @property", f"    def {name}(self) -> {translated(found[1], False)}:",
                      *quoted((member.__doc__ or "").strip(), " " * 8)]
            if member.fset:
                typed = translated(found[1], True)
                lines += [f"    @{name}.setter", f"    def {name}(self, value: {typed}) -> None: ..."]
                if name in getattr(kind, "_fields", []):
                    fields.append(f"{name}: {typed} = ...")
        elif callable(member) or isinstance(member, staticmethod):
            if name not in PASSED_OVER and getattr(kind, name).__doc__:
                methods.append((name, isinstance(member, staticmethod)))
    if hasattr(kind, "_fields"):
        lines.insert(0, "    _fields: ClassVar[List[str]]")
    if getattr(kind, "__hash__", None) is None:
        lines.append("    __hash__: ClassVar[None]  # type: ignore[assignment]")
    if not list(signatures(getattr(kind, "__init__").__doc__, "__init__")):
        lines += ["    def __init__(self, *args: Any, **kwargs: Any) -> None:",
                  '        """Not made in Python: raises TypeError."""']
    for name, is_static in methods:
        lines += function(name, getattr(kind, name).__doc__, "    ",
                          fields if hasattr(kind, "_fields") else None, is_static)
    return lines


def stub(module: ModuleType) -> str:
    lines = [HEAD]
    for name, value in vars(module).items():
        if name.startswith("__") and name != "__version__":
            continue
        if inspect.isclass(value):
            base = value.__bases__[0].__name__
            base = "metaclass=_Pybind11Type" if base == "pybind11_object" else base
            is_error = issubclass(value, Exception)
            body = quoted((value.__doc__ or "").split("\n\nMembers:")[0].strip(), "    ")
            if is_error:
                body += ["    kind: ClassVar[ErrorKind]"]
            else:
                body += enumeration(value) if hasattr(value, "__members__") else members(value)
            lines += [f"\nclass {name}({base}):", *(body or ["    ..."])]
        elif callable(value):
            lines += ["", *function(name, value.__doc__, "")]
        else:
            lines += ["", f"{name}: {type(value).__name__}"]
    return "\n".join(lines) + "\n"


def main(arguments: List[str]) -> Any:
    folder, output = arguments
    sys.path.insert(0, folder)
    import graticule._graticule

    with open(output, "w", encoding="utf-8") as file:
        file.write(stub(graticule._graticule))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
