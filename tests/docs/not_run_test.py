"""not_run_test.py COUNT PAGES...: how many blocks of commands are not run; a new one is a decision."""

import sys

import blocks

expected, pages = int(sys.argv[1]), sys.argv[2:]
found = run = 0
for page in pages:
    with open(page, encoding="utf-8") as file:
        shown, _ = blocks.read(file.read())
    for block in shown:
        run += not block.not_run
        if block.not_run:
            found += 1
            print(f"{page}:{block.line}: {block.not_run}")
print(f"{run} blocks of commands are run, {found} are not")
if found != expected:
    sys.exit(f"expected {expected} that are not: change tests/docs/CMakeLists.txt where that is meant")
if run < 20:
    sys.exit("hardly any block was found")
