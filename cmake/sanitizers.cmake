# AddressSanitizer and UndefinedBehaviorSanitizer for every target; any finding ends the process.
option(PWLSIM_SANITIZE "Build with ASan and UBSan" OFF)

if(PWLSIM_SANITIZE)
  # Eigen binds references to the elements of empty matrices (a circuit without sources has some) and never reads them.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize=null -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # It also adds offsets to the null pointers of empty matrices, which only clang looks at.
  add_compile_options($<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=pointer-overflow>)
  # Instrumented code makes g++ 12 see uninitialised reads in the standard library where there are none.
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  add_compile_definitions(_GLIBCXX_ASSERTIONS PWLSIM_SANITIZED)
  add_link_options(-fsanitize=address,undefined)
endif()

# The same, made for libFuzzer (tests/fuzz).
option(PWLSIM_FUZZ "Build the fuzz targets (clang)" OFF)

if(PWLSIM_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "PWLSIM_FUZZ needs clang: libFuzzer is part of it")
  endif()
  # Eigen also adds offsets to the null pointers of empty matrices.
  add_compile_options(-O1 -g1 -UNDEBUG -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize=null,pointer-overflow -fno-sanitize-recover=all)
  add_link_options(-fsanitize=address,undefined)
endif()
