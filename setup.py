"""pip install --no-build-isolation .: the module is built by CMake (python/CMakeLists.txt), for the Python that runs this.

PWLSIM_BUILD names a folder that CMake has configured with -DPWLSIM_PYTHON=ON for the same Python: what is built there is used, and built up.
"""

import os
import pathlib
import re
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        build = os.environ.get("PWLSIM_BUILD")
        if build is None:
            build = str(pathlib.Path(self.build_temp).resolve())
            options = ["-DCMAKE_BUILD_TYPE=Release", "-DPWLSIM_UNITY=ON", "-DPWLSIM_PYTHON=ON", f"-DPWLSIM_PYTHON_EXECUTABLE={sys.executable}"]
            subprocess.run(["cmake", "-S", str(HERE), "-B", build, "-G", "Ninja", *options], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "pwlsim_python"], check=True)
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        (module,) = pathlib.Path(build, "python", "pwlsim").glob("_core.*.so")
        self.copy_file(str(module), str(target))


version = re.search(r"project\(pwlsim VERSION ([0-9.]+)", (HERE / "CMakeLists.txt").read_text()).group(1)
setup(
    version=version,
    packages=["pwlsim"],
    package_dir={"pwlsim": "python/pwlsim"},
    package_data={"pwlsim": ["*.pyi", "py.typed"]},
    ext_modules=[Extension("pwlsim._core", [])],
    cmdclass={"build_ext": BuildByCMake},
)
