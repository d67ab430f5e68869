# What is loaded into other programs: the shared library (c/) and the Python package (python/).
option(PWLSIM_PYTHON "Build the Python package (Debian: pybind11-dev python3-dev python3-numpy)" OFF)
# Debian's pybind11, numpy and pytest belong to Debian's Python, whatever python3 comes first on PATH.
set(PWLSIM_PYTHON_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The Python that the package is built for")

if(PWLSIM_PYTHON)
  set(Python3_EXECUTABLE ${PWLSIM_PYTHON_EXECUTABLE})
  find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
  find_path(PWLSIM_PYBIND11_HEADERS pybind11/pybind11.h REQUIRED)
endif()
if(PWLSIM_PYTHON OR PWLSIM_SHARED)
  # One set of objects for the program and for what is loaded. Nothing is visible unless it says so: calls within stay direct.
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  set(CMAKE_CXX_VISIBILITY_PRESET hidden)
  set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
endif()
