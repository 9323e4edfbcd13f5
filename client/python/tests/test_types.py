"""The package is typed: its own code, and what a program sees of it."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import lpv

HERE = pathlib.Path(__file__).resolve().parent.parent
INSTALLED = pathlib.Path(lpv.__file__).resolve().parent


class Types(unittest.TestCase):
    def mypy(self, *arguments, cwd):
        options = ["--config-file", HERE / "mypy.ini", "--cache-dir", os.devnull]
        command = [sys.executable, "-m", "mypy", *options, *arguments]
        run = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
        return run.returncode, run.stdout + run.stderr

    def test_the_package_is_strictly_typed(self):
        self.assertTrue((INSTALLED / "py.typed").exists())
        status, said = self.mypy("-p", "lpv", cwd=INSTALLED.parent)
        self.assertEqual(status, 0, said)

    # Broken by leaving py.typed out: then everything is Any.
    def test_a_program_is_checked_against_it(self):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "program.py"
            program.write_text("import lpv\n"
                               "with lpv.connect() as client:\n"
                               "    session = client.create_session(grid=32)\n"
                               "    volume = session.volume('half', timeout=3.0)\n"
                               "    light = volume.fluence()\n"
                               "    wrong: str = volume.revision\n"
                               "    session.volume(formt='half')\n"
                               "    session.join().send('no operation')\n")
            status, said = self.mypy(program.name, cwd=folder)
            self.assertEqual(status, 1, said)
            self.assertIn("program.py:6: error", said)
            self.assertIn("program.py:7: error", said)
            self.assertIn("program.py:8: error", said)
            self.assertEqual(said.count("error:"), 3, said)


if __name__ == "__main__":
    unittest.main()
