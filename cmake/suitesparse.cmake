# SuiteSparse brings no CMake package in Debian 12. The libraries are named, not their files, so that a static program takes the archives.
find_path(PWLSIM_KLU_HEADERS klu.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(PWLSIM_KLU_LIBRARY klu REQUIRED)
add_library(pwlsim_suitesparse INTERFACE)
target_include_directories(pwlsim_suitesparse SYSTEM INTERFACE ${PWLSIM_KLU_HEADERS})
target_link_libraries(pwlsim_suitesparse INTERFACE klu btf amd colamd suitesparseconfig)
