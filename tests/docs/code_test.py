"""code_test.py PAGE CXX INCLUDES WORK: compiles the C++ that a page shows (see blocks.py), without running it.

A block that says GRATICULE_PLUGIN, GRATICULE_LENS_PLUGIN or main is a file of its own.  All others of a page are one
function, block after block; each may use the names of those before it, and name them anew.  Their #include and `using
namespace` lines come first in the file, as they would in a reader's."""

import os
import re
import subprocess
import sys
import time

import blocks

PAGE, CXX, INCLUDES, WORK = sys.argv[1:5]
WHOLE = re.compile(r"^(GRATICULE_PLUGIN\(|GRATICULE_LENS_PLUGIN\(|int main\()", re.M)


def lines_of(block):
    """(number in the page, line) of a block; what comments bring stands right above the fence."""
    given = "\n".join(block.before).splitlines()
    first = max(1, block.line - len(given))
    return [*enumerate(given, first), *enumerate(block.code, block.line + 1)]


def placed(lines):
    """Where the compiler finds fault, it names the page and its line."""
    text, last = [], None
    for number, line in lines:
        if last is None or number != last + 1:
            text.append(f'#line {number} "{PAGE}"')
        text.append(line)
        last = number
    return text


def one_function(shown):
    includes, names, body = [], [], ["void Page() {"]
    for block in shown:
        lines = lines_of(block)
        includes += placed(line for line in lines if line[1].startswith("#include "))
        names += placed(line for line in lines if line[1].startswith("using namespace "))
        body += ["{", *placed(line for line in lines if not line[1].startswith(("#include ", "using namespace ")))]
    return includes + names + body + ["}"] * (len(shown) + 1)


def compile_it(name, lines):
    os.makedirs(WORK, exist_ok=True)
    path = os.path.join(WORK, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    begin = time.monotonic()
    command = [CXX, "-std=c++17", "-fsyntax-only", "-Wall", "-Wextra", "-Wno-unused", "-Werror"]
    for folder in INCLUDES.split(":"):
        if folder != "/usr/include":  # the compiler's own, and its place among these matters
            command += ["-isystem", folder]
    done = subprocess.run([*command, path], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0:
        raise AssertionError(f"{done.stdout}\n{' '.join(command)} {path}: exit {done.returncode}")
    print(f"{name}: compiled [{time.monotonic() - begin:.1f} s]")


def main():
    with open(PAGE, encoding="utf-8") as file:
        shown, _ = blocks.read(file.read(), blocks.CODE)
    shown = [block for block in shown if not block.not_run]
    stem = os.path.splitext(os.path.basename(PAGE))[0]
    parts = []
    for block in shown:
        if WHOLE.search("\n".join(block.code)):
            compile_it(f"{stem}_{block.line}.cpp", placed(lines_of(block)))
        else:
            parts.append(block)
    if parts:
        compile_it(f"{stem}.cpp", one_function(parts))


if __name__ == "__main__":
    main()
