"""page_test.py PAGE PROGRAM SOURCE DATA [BUILT...]: runs what the page shows (see blocks.py), and holds every option that it
names against --help.  Exit code 77: recorded data are missing."""

import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

import blocks
from command_line import CommandLine

PAGE, PROGRAM, SOURCE, DATA = sys.argv[1:5]
BUILT = {os.path.basename(path): path for path in sys.argv[5:]}  # plug-ins
LINE = CommandLine(PROGRAM)


def check_words(where, words, is_whole):
    """A command that exists, with options that it has."""
    command, _ = LINE.split(words)
    if is_whole and not command and not {"--help", "--version"} & set(words):
        raise AssertionError(f"{where}: 'graticule {' '.join(words)}' names no command")
    known = LINE.options(command) | LINE.options(())
    if command == ("calibrate",) and "--guide" in words:  # as `calibrate guide`
        known |= LINE.options(("calibrate", "guide")) | {"--guide"}
    for word in words:
        if re.match(r"--?[a-zA-Z]", word) and word.partition("=")[0] not in known:
            raise AssertionError(f"{where}: graticule {' '.join(command)} has no option {word}")


def set_up(folder, given):
    for name, source in given.items():
        kind, colon, rest = source.partition(":")
        if not colon:
            pattern = os.path.join(DATA, source)
        else:
            pattern = {"source": os.path.join(SOURCE, rest), "built": BUILT.get(rest, rest)}[kind]
        paths = glob.glob(pattern)
        if not paths:
            if colon or os.environ.get("CI") == "true":
                raise AssertionError(f"{pattern} is missing")
            print(f"skipped: {pattern} is missing")
            sys.exit(77)
        for path in paths:
            copy = os.path.join(folder, name)
            if name.endswith("/"):
                copy += os.path.basename(path)
            os.makedirs(os.path.dirname(copy), exist_ok=True)
            shutil.copyfile(path, copy)  # a command may write over it


def run(where, folder, commands):
    environment = dict(os.environ, NO_COLOR="1")
    environment["PATH"] = os.path.dirname(os.path.abspath(PROGRAM)) + ":" + environment["PATH"]
    for command in commands:
        begin = time.monotonic()
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, env=environment)
        print(f"$ {command}   [{time.monotonic() - begin:.1f} s]")
        if done.returncode != 0:
            raise AssertionError(f"{where}: '{command}': exit {done.returncode}\n{done.stdout}")


def main():
    name = os.path.relpath(PAGE, SOURCE)
    with open(PAGE, encoding="utf-8") as file:
        shown, prose = blocks.read(file.read())
    for number, span in blocks.spans(prose):
        for words in blocks.graticule_words(span):
            check_words(f"{name}:{number}", words, is_whole=False)
    for block in shown:
        for command in block.before + block.commands:
            for words in blocks.graticule_words(command):
                check_words(f"{name}:{block.line}", words, is_whole=True)
    with tempfile.TemporaryDirectory() as folder:
        for block in shown:
            where = f"{name}:{block.line}"
            if block.not_run:
                print(f"{where}: not run: {block.not_run}")
                continue
            set_up(folder, block.given)
            run(where, folder, block.before + block.commands)


if __name__ == "__main__":
    main()
