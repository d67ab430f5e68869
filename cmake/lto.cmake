# Link-time optimisation of the rooms that a run spends its time in: a tenth to a sixth of `simulate`. Not of the tests' own programs, which would take half a minute each
# to link: beside tests objects also hold ordinary code. Elsewhere they do not, which is a third of their compile time. By g++ only; clang 14 cannot make such objects.
option(PWLSIM_LTO "Optimise the program as a whole when it is linked, where the compiler is g++" ON)
set(PWLSIM_LTO_ROOMS linalg lcp model engine)

set(PWLSIM_HAS_LTO OFF)
set(PWLSIM_HAS_ORDINARY_CODE ON)
if(PWLSIM_LTO AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug" AND NOT PWLSIM_SANITIZE AND NOT PWLSIM_THREAD_SANITIZER)
  set(PWLSIM_HAS_LTO ON)
  if(NOT PWLSIM_TESTS)
    set(PWLSIM_HAS_ORDINARY_CODE OFF)
    set(CMAKE_AR ${CMAKE_CXX_COMPILER_AR})  # with the compiler's plugin, which lists the symbols of such objects
    set(CMAKE_RANLIB ${CMAKE_CXX_COMPILER_RANLIB})
  endif()
  foreach(room IN LISTS PWLSIM_LTO_ROOMS)
    target_compile_options(pwlsim_${room} PRIVATE -flto=auto $<IF:$<BOOL:${PWLSIM_HAS_ORDINARY_CODE}>,-ffat-lto-objects,-fno-fat-lto-objects>)
  endforeach()
  # Instantiations that are called, not inlined: twice the compile time for nothing.
  set_source_files_properties(${PROJECT_SOURCE_DIR}/src/linalg/factorisations.cpp PROPERTIES COMPILE_OPTIONS -fno-lto)
  if(PWLSIM_HAS_ORDINARY_CODE)
    add_link_options($<IF:$<BOOL:$<TARGET_PROPERTY:PWLSIM_WHOLE>>,-flto=auto,-fno-lto>)
  else()
    add_link_options(-flto=auto)
  endif()
endif()

function(pwlsim_optimise_whole target)
  set_target_properties(${target} PROPERTIES PWLSIM_WHOLE ON)
endfunction()
