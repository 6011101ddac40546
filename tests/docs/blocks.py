"""The commands and the C++ that a page of the documentation shows.

A fenced block of `console` (lines that begin with `$ ` are typed, the others are what is answered), `bash` or `sh`
(every line is typed) is run by page_test.py in a folder of the page's own, block after block.  Comments right above
the fence say what a reader has at hand, or why a block is not run:

    <!-- given: intel.clf.gz = mapping/kuemmerle/intel.clf.gz; problem.fg = source:docs/examples/plugin/problem.fg -->
    <!-- given: images/ = calib/opencv_samples/images/left*.jpg; libradar.so = built:libradar.so -->
    <!-- before: graticule simulate bundle -o ring.fg -->
    <!-- not run: needs a camera -->

`given` names files of the recorded data, of the sources, or plug-ins of the build; NAME/ is a folder of all that match.  `before` is a command that the page does not
show.  What is `not run` is counted (CMakeLists.txt), and its options are held against --help all the same.

A block of `cpp` is compiled by code_test.py.  What a reader would have written himself stands in a comment, which may
have several lines, or the block says why it is left out:

    <!-- before: graticule::Graph graph(graticule::Builtins()); -->
    <!-- not compiled: an excerpt of a header -->

Blocks of `python` are run by python/tests/docs_test.py, with `before` as for C++."""

import re
import shlex
from dataclasses import dataclass, field

FENCES = ("console", "bash", "sh")
CODE = ("cpp",)
PYTHON = ("python",)


@dataclass
class Block:
    line: int
    commands: list = field(default_factory=list)  # as typed, continued lines joined
    code: list = field(default_factory=list)  # lines
    given: dict = field(default_factory=dict)
    before: list = field(default_factory=list)
    not_run: str = ""


def typed(language, lines):
    """The commands among a block's lines."""
    commands, is_open = [], False
    for line in lines:
        if is_open:
            commands[-1] += "\n" + re.sub(r"^> ", "", line)
        elif language != "console":
            if line.strip() and not line.startswith("#"):
                commands.append(line)
            else:
                continue
        elif line.startswith("$ "):
            commands.append(line[2:])
        else:
            continue
        is_open = commands[-1].endswith("\\")
    return commands


def read_comment(text, block):
    kind, _, value = text.partition(":")
    value = value.strip()
    if kind in ("not run", "not compiled") and value:
        block.not_run = value
    elif kind == "before" and value:
        block.before.append(value)
    elif kind == "given" and value:
        for pair in value.split(";"):
            name, equals, source = (part.strip() for part in pair.partition("="))
            if not equals or not source:
                raise ValueError(f"expected NAME = SOURCE, found '{pair.strip()}'")
            block.given[name] = source
    else:
        return False
    return True


def lines_of(text):
    """(number, text), with a comment's lines as one."""
    begin, whole = 0, ""
    for number, line in enumerate(text.splitlines(), 1):
        if not whole and not re.match(r"<!-- (?:given|before|not run|not compiled):", line):
            yield number, line
            continue
        begin, whole = (begin, whole + "\n" + line) if whole else (number, line)
        if line.endswith("-->"):
            yield begin, whole
            whole = ""
    if whole:
        raise ValueError(f"line {begin}: a comment without an end")


def read(text, languages=FENCES):
    """All blocks of the languages of a page, and the lines of prose (number, text) outside of any fence."""
    blocks, prose, fence, comments = [], [], None, []
    for number, line in lines_of(text):
        start = re.match(r"\s*```\s*(\S*)\s*$", line)
        if fence is not None:
            if start and not start[1]:
                language, begin, lines = fence
                fence = None
                if language in languages:
                    block = Block(begin)
                    for comment in comments:
                        if not read_comment(comment, block):
                            raise ValueError(f"line {begin}: what does '{comment}' mean?")
                    if language in FENCES:
                        block.commands = typed(language, lines)
                    block.code = lines
                    blocks.append(block)
                elif language not in FENCES and any(re.match(r"(\$ )?graticule ", shown) for shown in lines):
                    raise ValueError(f"line {begin}: commands belong into a block of console")
                comments = []
            else:
                fence[2].append(line)
        elif start:
            fence = (start[1], number, [])
        else:
            comment = re.match(r"<!-- ((?:given|before|not run|not compiled):.*?)\s*-->$", line, re.S)
            if comment:
                comments.append(comment[1])
            else:
                if comments:
                    raise ValueError(f"line {number}: a comment without a block below it")
                if re.match(r"    (\$ )?graticule ", line):
                    raise ValueError(f"line {number}: commands belong into a block of console")
                prose.append((number, line))
    return blocks, prose


def spans(prose):
    """Every `graticule ...` between backquotes: (line, text)."""
    for number, line in prose:
        for span in re.findall(r"`(graticule [^`]*)`", line):
            yield number, span


def graticule_words(command):
    """The words behind `graticule` of each part of a command line that calls it."""
    lexer = shlex.shlex(command.replace("\\\n", " "), posix=True, punctuation_chars="();<>|&")
    lexer.whitespace_split = True
    lexer.commenters = ""
    words, found = [], []
    for word in lexer:
        if set(word) <= set("();<>|&"):
            found.append(words)
            words = []
        elif word.startswith("#") and words:
            break
        else:
            words.append(word)
    found.append(words)
    return [words[1:] for words in found if words and words[0] == "graticule"]
