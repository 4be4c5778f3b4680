"""Builds the Python package: CMake makes the extension module, setuptools the wheel.

Environment: CMAKE_ARGS has further arguments for CMake. DARTCAST_BUILD names a build folder that
has the module already, as ./dev python makes it: it is taken from there.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
OPTIONS = ["CMAKE_BUILD_TYPE=Release", "CMAKE_UNITY_BUILD=ON", "BUILD_SHARED_LIBS=OFF", "CMAKE_POSITION_INDEPENDENT_CODE=ON",
           "DARTCAST_PYTHON=ON", "DARTCAST_APP=OFF"]


def version() -> str:
    """The project's version, from CMakeLists.txt."""
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(dartcast VERSION ([\d.]+)", text).group(1)


class BuildWithCMake(build_ext):
    """Builds the module and puts it, with the libraries it needs from here, into the package."""

    def build_extension(self, extension: Extension) -> None:
        build = os.environ.get("DARTCAST_BUILD")
        if not build:
            build = str(pathlib.Path(self.build_temp).resolve())
            options = [f"-D{option}" for option in [*OPTIONS, f"Python_EXECUTABLE={sys.executable}"]]
            subprocess.check_call(["cmake", "-S", str(ROOT), "-B", build, *options,
                                   *shlex.split(os.environ.get("CMAKE_ARGS", ""))])
        subprocess.check_call(["cmake", "--build", build, "--target", "dartcast_python", "--parallel",
                               str(os.cpu_count() or 1)])
        package = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve().parent
        subprocess.check_call(["cmake", "--install", build, "--component", "python", "--prefix", str(package)])


setup(version=version(), ext_modules=[Extension("dartcast._core", [])], cmdclass={"build_ext": BuildWithCMake})
