"""What `graticule --help` says of each command."""

import functools
import re
import subprocess


class CommandLine:
    """The commands of one graticule program, asked by --help."""

    def __init__(self, program):
        self.program = program

    @functools.lru_cache(maxsize=None)
    def help(self, words):
        """The help of `graticule WORDS`; words are a tuple."""
        done = subprocess.run([self.program, *words, "--help"], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"graticule {' '.join(words)} --help: {done.stderr}")
        return done.stdout

    def options(self, words):
        """Every name of every option of the command: {"-o", "--output"}."""
        names = set()
        for line in self.help(words).splitlines():
            match = re.match(r"  (-[^ ]*)", line)
            if match:
                # A flag that has a value shows it behind its name: --name{value}, or as its type.
                names.update(re.sub(r"[{\[=].*", "", name) for name in match[1].split(","))
        return names

    def commands(self, words):
        """The names of the commands below it, in order."""
        below = self.help(words).partition("\nSubcommands:\n")[2]
        names = []
        for line in below.splitlines():
            match = re.match(r"  ([a-z][a-z-]*)(?: |$)", line)
            if match:
                names.append(match[1])
            elif line and not line.startswith(" "):
                break
        return names

    def all_commands(self, words=()):
        """Every command's words, () first."""
        found = [words]
        for name in self.commands(words):
            found += self.all_commands(words + (name,))
        return found

    def split(self, words):
        """The command that words begin with, and the words after it."""
        command = ()
        for i, word in enumerate(words):
            if word in self.commands(command):
                command += (word,)
            elif not word.startswith("-"):
                return command, words[i:]
        return command, words[len(command):]
