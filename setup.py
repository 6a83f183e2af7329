"""Builds the package with CMake: the module of the library, and the program that runs the cases of sweeps. KLUFT_BUILD_DIR names a
build tree that is configured already."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
VERSION = re.search(r"project\(kluft VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")).group(1)


class CMakeBuild(build_ext):
    def run(self):
        given = os.environ.get("KLUFT_BUILD_DIR")
        tree = Path(given or Path(self.build_temp) / "cmake").absolute()
        if not given:
            options = {"CMAKE_BUILD_TYPE": "Release", "KLUFT_PYTHON": "ON", "KLUFT_UNITY": "ON", "KLUFT_BUILD_TESTS": "OFF",
                       "KLUFT_BUILD_CALIBRATE": "OFF", "Python_EXECUTABLE": sys.executable}
            words = [f"-D{key}={value}" for key, value in options.items()]
            subprocess.run(["cmake", "-S", ROOT, "-B", tree, "-G", "Ninja", *words], check=True)
        subprocess.run(["cmake", "--build", tree, "--parallel", str(os.cpu_count() or 1), "--target", "kluft_python", "kluft_cli"],
                       check=True)
        package = Path(self.build_lib).absolute() / "kluft"
        if self.inplace:
            package = ROOT / "python" / "kluft"
        (package / "bin").mkdir(parents=True, exist_ok=True)
        for module in (tree / "python" / "kluft").glob("_core*.so"):
            shutil.copy2(module, package)
        shutil.copy2(tree / "kluft", package / "bin")


setup(version=VERSION, packages=["kluft"], package_dir={"": "python"}, package_data={"kluft": ["py.typed", "*.pyi"]},
      ext_modules=[Extension("kluft._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
