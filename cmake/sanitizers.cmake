# AddressSanitizer and UndefinedBehaviorSanitizer for every target; any finding ends the process.
option(PWLSIM_SANITIZE "Build with ASan and UBSan" OFF)

if(PWLSIM_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # Rows of empty matrices begin at an offset to a null pointer, and nothing reads them.
  add_compile_options($<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=pointer-overflow>)
  add_compile_options($<$<CXX_COMPILER_ID:Clang>:-fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/sanitizers.ignore>)
  # g++ has no such list. Eigen binds references to the elements of empty matrices (a circuit without sources has some) and never reads them.
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fno-sanitize=null>)
  # Instrumented code makes g++ 12 see uninitialised reads in the standard library where there are none.
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  add_compile_definitions(_GLIBCXX_ASSERTIONS PWLSIM_SANITIZED)
  add_link_options(-fsanitize=address,undefined)
  # Rooms in which tests spend little time compile in half of it without optimisation.
  set(PWLSIM_ROOMS_AS_WRITTEN netlist elements circuit spice analysis api cli)
endif()

# ThreadSanitizer, for the threads of .step: a race is told on standard error, and the process ends with status 66.
option(PWLSIM_THREAD_SANITIZER "Build with TSan" OFF)

if(PWLSIM_THREAD_SANITIZER)
  if(PWLSIM_SANITIZE)
    message(FATAL_ERROR "PWLSIM_THREAD_SANITIZER and PWLSIM_SANITIZE exclude each other")
  endif()
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  add_link_options(-fsanitize=thread)
endif()

# ASan and UBSan, made for libFuzzer (tests/fuzz).
option(PWLSIM_FUZZ "Build the fuzz targets (clang)" OFF)

if(PWLSIM_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "PWLSIM_FUZZ needs clang: libFuzzer is part of it")
  endif()
  add_compile_options(-O1 -g1 -UNDEBUG -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize=pointer-overflow
    -fno-sanitize-recover=all -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/cmake/sanitizers.ignore)
  add_link_options(-fsanitize=address,undefined)
endif()
