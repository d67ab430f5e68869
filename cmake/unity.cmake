# Files of a room compiled several at a time: half the work of a build from nothing, since Eigen and the standard library are read and
# instantiated once for all of them. For ./run, ./test and the sanitizers; whoever edits compiles file by file.
option(PWLSIM_UNITY "Compile the files of a room in groups" OFF)
set(PWLSIM_FILES_TOGETHER 8)

# What is private to a file is then so to its group. These rooms and files have a constant or a type whose name another of the room has, too.
set(PWLSIM_ROOMS_APART elements measure netlist)
set(PWLSIM_FILES_APART
  analysis/report
  circuit/control_switches circuit/evaluator circuit/formula_functions circuit/formula_reader circuit/functions circuit/measured_expression circuit/measurement_card circuit/models circuit/random
  circuit/scope circuit/sections circuit/values circuit/sweep_card circuit/transient_card circuit/xspice_logic
  engine/exact/control_probe engine/exact/locator_series engine/exact/modal_search engine/exact/piece_maker engine/exact/probe_impulses engine/exact/static_mode engine/exact/static_ports
  engine/exact/exact_run engine/sparse/part_run engine/sparse/part_run_events engine/sparse/step_certifier engine/sparse/interior_point
  engine/sparse/port_solver engine/sparse/start engine/sparse/stretch engine/sparse/sparse_run
  lcp/principal_pivoting
  linalg/careful_elimination linalg/factorisations
  model/build_mode model/slow_manifold
  model/verify
  spice/study)

function(pwlsim_compile_together room)
  if(NOT PWLSIM_UNITY OR room IN_LIST PWLSIM_ROOMS_APART)
    return()
  endif()
  set_target_properties(pwlsim_${room} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${PWLSIM_FILES_TOGETHER})
  # Types of unnamed namespaces in a file that another includes.
  target_compile_options(pwlsim_${room} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  list(TRANSFORM PWLSIM_FILES_APART PREPEND ${PROJECT_SOURCE_DIR}/src/ OUTPUT_VARIABLE apart)
  list(TRANSFORM apart APPEND .cpp)
  set_source_files_properties(${apart} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
