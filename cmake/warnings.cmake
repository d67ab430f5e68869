# Warnings every target of the project is compiled with; errors where PWLSIM_WERROR is on (CI, dev).
option(PWLSIM_WERROR "Treat warnings as errors" OFF)

add_library(pwlsim_warnings INTERFACE)
target_compile_options(pwlsim_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wnon-virtual-dtor -Woverloaded-virtual -Wcast-qual
  # Of files compiled together clang also counts private names of other files that hide nothing.
  $<$<OR:$<CXX_COMPILER_ID:GNU>,$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>>:-Wshadow>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # g++ 12 reports it wrongly for "text" + std::string (GCC bug 105651)
  $<$<BOOL:${PWLSIM_WERROR}>:-Werror>)
