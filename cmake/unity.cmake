# Files of a room, or of a folder of tests, compiled together: Eigen and the standard library are read and instantiated once for all of them, which is most of
# the work of a build from nothing. For ./run, ./test and the sanitizers; whoever edits compiles file by file.
option(PWLSIM_UNITY "Compile the files of a room, or of a folder of tests, in groups" OFF)
set(PWLSIM_FILES_TOGETHER 36)
set(PWLSIM_TESTS_TOGETHER 20)  # up to 36 s and 2 GB a group

# g++ then collects garbage less often: 3 to 20 % of a unit's time for up to 2.6 GB of memory instead of 2.3, where there is enough for each processor.
cmake_host_system_information(RESULT PWLSIM_MEMORY QUERY TOTAL_PHYSICAL_MEMORY)  # MiB
cmake_host_system_information(RESULT PWLSIM_PROCESSORS QUERY NUMBER_OF_LOGICAL_CORES)
math(EXPR PWLSIM_MEMORY_EACH "${PWLSIM_MEMORY} / ${PWLSIM_PROCESSORS}")
set(PWLSIM_GARBAGE "")
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND PWLSIM_MEMORY_EACH GREATER 3500)
  set(PWLSIM_GARBAGE --param=ggc-min-heapsize=1048576)  # KiB
endif()

# What is private to a file is then so to its group, so its name belongs to one file of the room or folder. Compiled alone: the vocabularies of two grammars,
# and instantiations without link-time optimisation.
set(PWLSIM_FILES_APART linalg/factorisations netlist/card_grammar netlist/token_grammar)

# pwlsim_compile_together(TARGET MOST MORE): groups of about one size, of MOST files at most; up to MORE files that the target gets later join the last one.
function(pwlsim_compile_together target most more)
  if(NOT PWLSIM_UNITY)
    return()
  endif()
  get_target_property(files ${target} SOURCES)
  list(LENGTH files count)
  math(EXPR groups "(${count} + ${most} - 1) / ${most}")
  math(EXPR size "(${count} + ${groups} - 1) / ${groups} + ${more}")
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
  # Types of unnamed namespaces in a file that another includes.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage> ${PWLSIM_GARBAGE})
  list(TRANSFORM PWLSIM_FILES_APART PREPEND ${PROJECT_SOURCE_DIR}/src/ OUTPUT_VARIABLE apart)
  list(TRANSFORM apart APPEND .cpp)
  set_source_files_properties(${apart} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
