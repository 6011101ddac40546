"""manual_test.py PROGRAM MANUAL: the manual's pages and the completions against --help, and rendered.

MANUAL is the folder that the build has written them to (cmake/GraticuleManual.cmake)."""

import gzip
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from command_line import CommandLine

PROGRAM, MANUAL = sys.argv[1:3]
LINE = CommandLine(PROGRAM)
IN_CI = os.environ.get("CI") == "true"


def needs(tool):
    if shutil.which(tool) is None:
        if IN_CI:
            raise AssertionError(f"{tool} is missing: .ci/packages.txt has it")
        raise unittest.SkipTest(f"{tool} is missing")


def page_file(words):
    return os.path.join(MANUAL, "man1", "-".join(("graticule",) + words) + ".1.gz")


def page(words):
    with gzip.open(page_file(words), "rt", encoding="utf-8") as file:
        return file.read()


def complete(*words):
    """What bash offers behind these words; the last one may be begun, or empty."""
    script = (
        "source \"$1\"; shift; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _graticule; "
        "printf '%s\\n' \"${COMPREPLY[@]}\""
    )
    done = subprocess.run(
        ["bash", "-c", script, "bash", os.path.join(MANUAL, "bash"), "graticule", *words],
        capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return [word for word in done.stdout.split("\n") if word]


class Pages(unittest.TestCase):
    def test_there_are_as_many_as_commands(self):
        expected = {os.path.basename(page_file(words)) for words in LINE.all_commands()}
        self.assertGreater(len(expected), 25)
        self.assertEqual(set(os.listdir(os.path.join(MANUAL, "man1"))),
                         expected | {"graticule-vision.1.gz", "graticule-mpi.1.gz"})

    def test_every_option_of_help_is_in_its_page(self):
        for words in LINE.all_commands():
            text = page(words).replace("\\-", "-")
            for option in LINE.options(words):
                self.assertIn(f"\\fB{option}\\fR", text, f"graticule {' '.join(words)}")

    def test_every_word_of_help_is_in_its_page(self):
        """Choices, too, and what an option is for: letters and digits of the one are in the other."""
        plain = lambda text: re.sub(r"[^A-Za-z0-9]+", " ", text).lower()
        for words in LINE.all_commands():
            roff = re.sub(r"\\f[BIR]|\\&", "", page(words)).replace("\\-", "-")
            roff = plain(re.sub(r"\\\((aq|ga|ha|ti)", "'", roff))
            for choice in re.findall(r"\{([^{}]*)\}", LINE.help(words)):
                for word in choice.split(","):
                    self.assertIn(plain(word), roff, f"graticule {' '.join(words)}: {choice}")

    def test_every_page_renders_without_a_warning(self):
        needs("man")
        needs("groff")
        for words in LINE.all_commands() + [("vision",), ("mpi",)]:
            environment = dict(os.environ, MANWIDTH="80", LC_ALL="C.UTF-8")
            done = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", page_file(words)],
                                  capture_output=True, text=True, env=environment)
            self.assertEqual((done.returncode, done.stderr), (0, ""), page_file(words))
            self.assertIn("NAME", done.stdout)

    def test_a_page_says_what_people_look_for(self):
        needs("man")
        done = subprocess.run(["man", "-E", "UTF-8", "-l", page_file(("solve",))], text=True,
                              capture_output=True, env=dict(os.environ, MANWIDTH="80", LC_ALL="C.UTF-8"))
        text = re.sub(r".\x08", "", done.stdout)
        for part in ("graticule-solve - solve a recorded problem", "-o, --output TEXT",
                     "--reject-outliers[=TEXT]", "Default: se.", "EXAMPLES",
                     "graticule solve city10000.g2o.gz -o solved.g2o --plot city.svg"):
            self.assertIn(part, text)


class Completions(unittest.TestCase):
    def test_bash_offers_every_option_of_every_command(self):
        for words in LINE.all_commands():
            offered = set(complete(*words, "-"))
            self.assertEqual(offered - {"-q", "--quiet"}, LINE.options(words) - {"-q", "--quiet"},
                             f"graticule {' '.join(words)}")
            self.assertIn("--quiet", offered)

    def test_bash_offers_every_command(self):
        for words in LINE.all_commands():
            below = LINE.commands(words)
            if below:
                self.assertTrue(set(below) <= set(complete(*words, "")), words)
        self.assertEqual(complete("so"), ["solve"])
        self.assertEqual(complete("calibrate", "gu"), ["guide"])

    def test_bash_offers_choices(self):
        self.assertEqual(complete("solve", "--align", ""), ["se", "sim", "first", "none"])
        self.assertEqual(complete("simulate", "c"), ["city", "corrupt"])
        self.assertEqual(complete("solve", "--reject-outliers", "=", "gnc"), ["gnc-tls", "gnc-gm"])
        self.assertEqual(complete("solve", "--reject-outliers", "--js"), ["--json"])

    def test_bash_offers_files_with_spaces(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "a b.g2o")
            open(name, "w").close()
            self.assertEqual(complete("solve", os.path.join(folder, "a")), [name])
            self.assertEqual(complete("solve", "--output", os.path.join(folder, "a")), [name])
            self.assertEqual(complete("compare", "--repeats", os.path.join(folder, "a")), [])

    def test_every_shell_knows_every_option(self):
        for shell in ("zsh", "fish"):
            with open(os.path.join(MANUAL, shell)) as file:
                text = file.read()
            for words in LINE.all_commands():
                for option in LINE.options(words):
                    name = option.lstrip("-")
                    spelled = option if shell == "zsh" else (
                        f"-l {name} " if option.startswith("--") else f"-s {name} ")
                    self.assertIn(spelled, text, f"{shell}: graticule {' '.join(words)} {option}")

    def test_shells_that_are_here_take_their_scripts(self):
        for shell in ("bash", "zsh", "fish"):
            if shutil.which(shell):
                done = subprocess.run([shell, "-n", os.path.join(MANUAL, shell)],
                                      capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""), shell)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
