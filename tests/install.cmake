# What cmake --install puts where, and that it works there. -DBUILD= is the build folder, -DCOMPILER=, -DFLAGS= what the library was compiled with.
set(prefix ${BUILD}/installed)
file(REMOVE_RECURSE ${prefix})

function(run result)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output ERROR_VARIABLE errors RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN} ended with ${status}: ${output}${errors}")
  endif()
  set(${result} "${output}" PARENT_SCOPE)
endfunction()

# As after ./run, which builds the program alone.
file(REMOVE ${BUILD}/libpwlsim.a)
run(ignored ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
foreach(name bin/pwlsim share/man/man1/pwlsim.1 share/bash-completion/completions/pwlsim share/zsh/site-functions/_pwlsim
             share/fish/vendor_completions.d/pwlsim.fish share/doc/pwlsim/LICENSE
             share/doc/pwlsim/docs/tutorial/README.md share/doc/pwlsim/netlists/buck.net share/doc/pwlsim/examples/buck/buck.cpp
             include/pwlsim/pwlsim.hpp)
  if(NOT EXISTS ${prefix}/${name})
    message(SEND_ERROR "${name} is not installed")
  endif()
endforeach()

# A node at 1 V behind a resistor stays there.
file(WRITE ${prefix}/one.net "one volt\nV1 a 0 1\nR1 a b 1\nR2 b 0 1\n.save v(b)\n.tran 1 2\n")
run(rows ${prefix}/bin/pwlsim ${prefix}/one.net -o - --quiet)
if(NOT rows STREQUAL "time,v(b)\n0,0.5\n1,0.5\n2,0.5\n")
  message(SEND_ERROR "the installed program gives ${rows}")
endif()

file(READ ${prefix}/share/man/man1/pwlsim.1 manual)
file(READ ${prefix}/share/bash-completion/completions/pwlsim completion)
string(REPLACE "\\-" "-" manual "${manual}")
file(READ ${prefix}/share/zsh/site-functions/_pwlsim zsh_completion)
file(READ ${prefix}/share/fish/vendor_completions.d/pwlsim.fish fish_completion)
string(REPLACE "-l " "--" fish_completion "${fish_completion}")
foreach(command "" inspect export compare)
  run(help ${prefix}/bin/pwlsim ${command} --help)
  string(REGEX MATCHALL "--[a-z-]+" options "${help}")
  list(REMOVE_DUPLICATES options)
  if(NOT options)
    message(SEND_ERROR "pwlsim ${command} --help names no options")
  endif()
  foreach(option IN LISTS options)
    foreach(page manual completion zsh_completion fish_completion)
      if(NOT ${page} MATCHES "${option}")
        message(SEND_ERROR "${option} of pwlsim ${command} is not in the ${page}")
      endif()
    endforeach()
  endforeach()
endforeach()

find_program(BASH bash)
if(BASH)
  file(WRITE ${prefix}/complete.bash "source ${prefix}/share/bash-completion/completions/pwlsim
try() { COMP_WORDS=(\"$@\") && COMP_CWORD=$(($# - 1)) && _pwlsim pwlsim \"\${!#}\" \"\${COMP_WORDS[COMP_CWORD - 1]}\" && echo \"\${COMPREPLY[@]}\"; }
try pwlsim inspect --m
try pwlsim --engine s
")
  run(words ${BASH} ${prefix}/complete.bash)
  if(NOT words STREQUAL "--mode\nsparse\n")
    message(SEND_ERROR "bash completes to ${words}")
  endif()
endif()

foreach(shell zsh fish)
  find_program(${shell}_program ${shell})
  if(${shell}_program)
    file(GLOB_RECURSE script ${prefix}/share/${shell}/*pwlsim*)
    run(ignored ${${shell}_program} -n ${script})  # reads it without running it
  endif()
endforeach()

# Another project finds the library; its program compares each number with the textbook's.
run(ignored ${CMAKE_COMMAND} -S ${prefix}/share/doc/pwlsim/examples/buck -B ${prefix}/build -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_COMPILER=${COMPILER}
  -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_BUILD_TYPE=Debug)
run(ignored ${CMAKE_COMMAND} --build ${prefix}/build)
run(table ${prefix}/build/buck)
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG)
  file(GLOB_RECURSE description ${prefix}/pwlsim.pc)
  cmake_path(GET description PARENT_PATH descriptions)
  run(flags ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${descriptions} ${PKG_CONFIG} --cflags pwlsim)
  string(STRIP "${flags}" flags)
  string(REGEX REPLACE "^-I" "" flags "${flags}")
  if(NOT EXISTS ${flags}/pwlsim/pwlsim.hpp)
    message(SEND_ERROR "pkg-config leads to ${flags}")
  endif()
endif()
if(NOT table MATCHES "\n0.50   1.276595745 A   1.276595745 A")
  message(SEND_ERROR "the example prints ${table}")
endif()
