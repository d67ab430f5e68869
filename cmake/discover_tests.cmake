# cmake -DPROGRAM= -DPREFIX= -DOUTPUT= -DTIMEOUT= -P discover_tests.cmake: writes one add_test for each Catch2 test case of PROGRAM.
# A test that prints "… is not installed: this test is skipped" counts as skipped, not as passed.
# The label of a test is the first of these tags it carries; [long] stands before all, so that it can be left out. A test without any fails the build.
set(labels long unit property golden regression hard)

# Names of the test cases that match the Catch2 test specification, with brackets encoded: CMake lists trip over them.
function(list_names specification result)
  execute_process(COMMAND ${PROGRAM} ${specification} --list-test-names-only OUTPUT_VARIABLE text ERROR_VARIABLE problem)
  if(problem)
    message(FATAL_ERROR "${PROGRAM}: ${problem}")
  endif()
  string(REPLACE "[" "@(@" text "${text}")
  string(REPLACE "]" "@)@" text "${text}")
  string(REPLACE ";" "@,@" text "${text}")
  string(STRIP "${text}" text)
  string(REPLACE "\n" ";" names "${text}")
  set(${result} "${names}" PARENT_SCOPE)
endfunction()

set(script "")
set(others "")
foreach(label IN LISTS labels)
  list_names("[${label}]${others}" names)
  string(APPEND others "~[${label}]")
  foreach(name IN LISTS names)
    string(REPLACE "@(@" "[" name "${name}")
    string(REPLACE "@)@" "]" name "${name}")
    string(REPLACE "@,@" ";" name "${name}")
    string(REGEX REPLACE "([][,\\]|^[-~])" "\\\\\\1" filter "${name}")
    string(APPEND script "add_test([==[${PREFIX}: ${name}]==] [==[${PROGRAM}]==] [==[${filter}]==] --warn NoTests)\n"
      "set_tests_properties([==[${PREFIX}: ${name}]==] PROPERTIES LABELS ${label} SKIP_REGULAR_EXPRESSION \"is not installed: this test is skipped\"")
    if(NOT label STREQUAL long)
      string(APPEND script " TIMEOUT ${TIMEOUT}")
    endif()
    string(APPEND script ")\n")
  endforeach()
endforeach()

list_names("${others}" names)
if(names)
  message(FATAL_ERROR "test cases without one of the tags ${labels}: ${names}")
endif()
file(WRITE ${OUTPUT} "${script}")
