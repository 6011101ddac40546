"""What docs/python.md shows, run."""

import contextlib
import io
import os
import re
import tempfile
import unittest


class Docs(unittest.TestCase):
    def test_blocks_run_one_after_the_other(self):
        path = os.path.join(os.environ["GRATICULE_SOURCE_DIR"], "docs", "python.md")
        with open(path, encoding="utf-8") as file:
            blocks = re.findall(r"^```python\n(.*?)^```", file.read(), re.M | re.S)
        self.assertGreater(len(blocks), 3)
        names = {}
        here = os.getcwd()
        output = io.StringIO()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(output):
            os.chdir(folder)
            try:
                for block in blocks:
                    exec(compile(block, path, "exec"), names)
            finally:
                os.chdir(here)
        self.assertIn("Report(converged", output.getvalue())
        self.assertIn("ErrorKind.INPUT", output.getvalue())


if __name__ == "__main__":
    unittest.main()
