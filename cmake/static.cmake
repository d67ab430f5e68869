# Without a dynamic linker the program starts a millisecond sooner, and its first run has fewer page faults.
# Only where the compiler can, and not under sanitizers, which need their own runtime libraries.
option(PWLSIM_STATIC "Link the program statically where the system has the libraries" ON)

set(PWLSIM_LINKS_STATICALLY OFF)
if(PWLSIM_STATIC AND NOT PWLSIM_SANITIZE AND NOT PWLSIM_THREAD_SANITIZER AND NOT PWLSIM_FUZZ)
  try_compile(PWLSIM_CAN_LINK_STATICALLY ${PROJECT_BINARY_DIR}/can_link_statically
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/fmt_library.cpp ${CMAKE_CURRENT_LIST_DIR}/can_link_statically.cpp
    LINK_OPTIONS -static CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON)
  set(PWLSIM_LINKS_STATICALLY ${PWLSIM_CAN_LINK_STATICALLY})
endif()

# Debian's fmt has headers and a shared library. The same code from the headers makes a static one.
if(PWLSIM_LINKS_STATICALLY)
  add_library(pwlsim_fmt STATIC ${CMAKE_CURRENT_LIST_DIR}/fmt_library.cpp)
  target_include_directories(pwlsim_fmt SYSTEM INTERFACE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_INCLUDE_DIRECTORIES>)
else()
  add_library(pwlsim_fmt INTERFACE)
  target_link_libraries(pwlsim_fmt INTERFACE fmt::fmt)
endif()

function(pwlsim_link_statically target)
  if(PWLSIM_LINKS_STATICALLY)
    target_link_options(${target} PRIVATE -static)
  endif()
endfunction()
