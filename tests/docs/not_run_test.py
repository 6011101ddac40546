"""not_run_test.py COMMANDS CODE PAGES...: how many blocks of commands are not run, and of code not compiled; a new one is
a decision."""

import sys

import blocks

pages = sys.argv[3:]


def hold(what, languages, expected, at_least):
    left_out = taken = 0
    for page in pages:
        with open(page, encoding="utf-8") as file:
            shown, _ = blocks.read(file.read(), languages)
        for block in shown:
            taken += not block.not_run
            if block.not_run:
                left_out += 1
                print(f"{page}:{block.line}: {block.not_run}")
    print(f"{taken} blocks of {what}, {left_out} are not")
    if left_out != expected:
        sys.exit(f"expected {expected} that are not: change tests/docs/CMakeLists.txt where that is meant")
    if taken < at_least:
        sys.exit("hardly any block was found")


hold("commands are run", blocks.FENCES, int(sys.argv[1]), 20)
hold("C++ are compiled", blocks.CODE, int(sys.argv[2]), 10)
