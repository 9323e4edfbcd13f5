"""Makes the stubs of proto/lpv/v1 while the package is built: messages (lpv/v1/*_pb2.py, with types in .pyi) and calls
(*_pb2_grpc.py). It needs protoc 3.21 and grpc_python_plugin (Debian 12: protobuf-compiler, protobuf-compiler-grpc).

    setup.py stubs DIR      makes them in DIR, without the package
"""

import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import setup
from setuptools.command.build_py import build_py

PROTOS = pathlib.Path(__file__).resolve().parents[2] / "proto"
PROTOC = "3.21"  # pyproject.toml's range of protobuf is that of this release


def tool(name):
    path = shutil.which(name)
    if path is None:
        raise SystemExit(f"{name} is not on the PATH; on Debian 12: apt-get install protobuf-compiler "
                         "protobuf-compiler-grpc")
    return path


def checked_protoc():
    protoc = tool("protoc")
    said = subprocess.run([protoc, "--version"], capture_output=True, text=True, check=True).stdout
    version = re.search(r"(\d+\.\d+)", said)
    if version is None or version[1] != PROTOC:
        raise SystemExit(f"{protoc} is \"{said.strip()}\"; the stubs are made by protoc {PROTOC}: those of another "
                         "release run with another range of protobuf than pyproject.toml names")
    return protoc


def make_stubs(folder):
    """Fills folder/lpv/v1."""
    protos = sorted((PROTOS / "lpv" / "v1").glob("*.proto"))
    if not protos:
        raise SystemExit(f"there are no protos in {PROTOS}: build the package from a whole checkout")
    package = pathlib.Path(folder) / "lpv" / "v1"
    package.mkdir(parents=True, exist_ok=True)
    subprocess.run([checked_protoc(), f"--proto_path={PROTOS}", f"--python_out={folder}", f"--pyi_out={folder}",
                    f"--grpc_python_out={folder}", f"--plugin=protoc-gen-grpc_python={tool('grpc_python_plugin')}",
                    *map(str, protos)], check=True)
    (package / "__init__.py").write_text('"""Stubs made from proto/lpv/v1."""\n')


class BuildWithStubs(build_py):
    def run(self):
        super().run()
        make_stubs(self.build_lib)


if sys.argv[1:2] == ["stubs"] and len(sys.argv) == 3:
    make_stubs(sys.argv[2])
else:
    setup(cmdclass={"build_py": BuildWithStubs})
