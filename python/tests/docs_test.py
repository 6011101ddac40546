"""The Python that README.md and docs/*.md show, run (tests/docs/blocks.py says how)."""

import contextlib
import glob
import io
import os
import sys
import tempfile
import unittest

SOURCE = os.environ["GRATICULE_SOURCE_DIR"]
sys.path.insert(0, os.path.join(SOURCE, "tests", "docs"))
import blocks  # noqa: E402


def run(path):
    """A page's blocks, one after the other, in a folder of its own: how many there were, and what they printed."""
    with open(path, encoding="utf-8") as file:
        shown, _ = blocks.read(file.read(), blocks.PYTHON)
    names = {}
    here = os.getcwd()
    output = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(output):
        os.chdir(folder)
        try:
            for block in shown:
                code = "\n".join(block.before + block.code)
                exec(compile(code, path, "exec"), names)
        finally:
            os.chdir(here)
    return len(shown), output.getvalue()


class Docs(unittest.TestCase):
    def test_every_page_runs(self):
        pages = glob.glob(os.path.join(SOURCE, "docs", "*.md")) + [os.path.join(SOURCE, "README.md")]
        found = {os.path.basename(page): run(page) for page in pages}
        count, output = found["python.md"]
        self.assertGreater(count, 3)
        self.assertIn("Report(converged", output)
        self.assertIn("ErrorKind.INPUT", output)
        self.assertEqual(found["README.md"][0], 1)
        self.assertIn("Report(converged", found["README.md"][1])


if __name__ == "__main__":
    unittest.main()
