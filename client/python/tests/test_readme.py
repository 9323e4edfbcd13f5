"""The examples of this package's README, and of the repository's, as they stand there."""

import ast
import asyncio
import contextlib
import inspect
import io
import os
import pathlib
import re
import tempfile
import unittest

from server import Server

PACKAGE = pathlib.Path(__file__).resolve().parent.parent


class Examples(unittest.TestCase):
    def setUp(self):
        self.server = Server()
        self.addCleanup(self.server.close)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def run_all(self, page):
        """Every block of Python of the page, one after the other; what they leave behind and print."""
        names, printed = {}, io.StringIO()
        blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
        for number, block in enumerate(blocks):
            source = block.replace("localhost:50051", self.server.address)
            code = compile(source, f"{page.name}, example {number}", "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
            with contextlib.redirect_stdout(printed):
                if code.co_flags & inspect.CO_COROUTINE:
                    asyncio.run(eval(code, names))
                else:
                    exec(code, names)
        return names, printed.getvalue()

    def test_the_packages(self):
        names, printed = self.run_all(PACKAGE / "README.md")
        self.assertEqual(names["pending"][-1].result(0).revision, 31)
        self.assertIn("32 ", printed.split("\n")[0] + " ")  # the revision behind the undo
        self.assertIn("['lamp']", printed)

    def test_the_repositorys(self):
        names, _ = self.run_all(PACKAGE.parents[1] / "README.md")
        self.assertGreater(names["light"].max(), 0)


if __name__ == "__main__":
    unittest.main()
