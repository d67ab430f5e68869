# pwlsim::pwlsim for other projects: one archive of all rooms that the public headers of include/pwlsim need, found by find_package(pwlsim).
include(CMakePackageConfigHelpers)

function(pwlsim_rooms_below room result)
  set(rooms ${room})
  foreach(other IN LISTS PWLSIM_ROOMS_OF_${room})
    pwlsim_rooms_below(${other} below)
    list(APPEND rooms ${below})
  endforeach()
  list(REMOVE_DUPLICATES rooms)
  set(${result} "${rooms}" PARENT_SCOPE)
endfunction()

pwlsim_rooms_below(api rooms)
add_library(pwlsim_library STATIC)
set_target_properties(pwlsim_library PROPERTIES OUTPUT_NAME pwlsim EXPORT_NAME pwlsim)
set(optimised "")
foreach(target IN LISTS rooms ITEMS fmt)
  get_target_property(type pwlsim_${target} TYPE)
  if(NOT type STREQUAL STATIC_LIBRARY)
    continue()
  elseif(target IN_LIST PWLSIM_LTO_ROOMS AND NOT PWLSIM_HAS_ORDINARY_CODE)
    list(APPEND optimised $<TARGET_OBJECTS:pwlsim_${target}>)
  else()
    target_sources(pwlsim_library PRIVATE $<TARGET_OBJECTS:pwlsim_${target}>)
  endif()
endforeach()
if(optimised)  # only this very compiler could read them: one object of ordinary code is made of them
  # As one partition: g++ 12 fails at several (in add_symbol_to_partition_1).
  set(object ${PROJECT_BINARY_DIR}/generated/optimised.o)
  add_custom_command(OUTPUT ${object} DEPENDS ${optimised} COMMAND_EXPAND_LISTS VERBATIM
    COMMAND ${CMAKE_CXX_COMPILER} -w -flto -flto-partition=one -flinker-output=nolto-rel -r -nostdlib -o ${object} ${optimised})
  set_source_files_properties(${object} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  target_sources(pwlsim_library PRIVATE ${object})
endif()
target_compile_features(pwlsim_library INTERFACE cxx_std_20)
target_include_directories(pwlsim_library INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# These targets are made by the package's configuration file.
target_link_libraries(pwlsim_library INTERFACE $<INSTALL_INTERFACE:pwlsim::dependencies>)

set(PWLSIM_NEEDS_FMT TRUE)
if(PWLSIM_LINKS_STATICALLY)
  set(PWLSIM_NEEDS_FMT FALSE)  # it is in the archive
endif()
set(PWLSIM_FMT_FLAG "")
if(PWLSIM_NEEDS_FMT)
  set(PWLSIM_FMT_FLAG " -lfmt")
endif()
file(RELATIVE_PATH PWLSIM_PREFIX_OF_PKGCONFIG /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(packaging/pwlsim.pc.in ${PROJECT_BINARY_DIR}/packaging/pwlsim.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/packaging/pwlsim.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pwlsim)
configure_package_config_file(cmake/pwlsim-config.cmake.in ${PROJECT_BINARY_DIR}/packaging/pwlsim-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/packaging/pwlsim-config-version.cmake COMPATIBILITY SameMinorVersion)

install(TARGETS pwlsim_library EXPORT pwlsim ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT pwlsim NAMESPACE pwlsim:: FILE pwlsim-targets.cmake DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/packaging/pwlsim-config.cmake ${PROJECT_BINARY_DIR}/packaging/pwlsim-config-version.cmake DESTINATION ${package_dir})
install(DIRECTORY include/pwlsim DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(PWLSIM_HAS_LTO AND PWLSIM_HAS_ORDINARY_CODE AND CMAKE_OBJCOPY)
  # Only this very compiler could read what it would optimise.
  add_custom_command(TARGET pwlsim_library POST_BUILD VERBATIM
    COMMAND ${CMAKE_OBJCOPY} --wildcard --remove-section=.gnu.lto_* --remove-section=.gnu.debuglto_* $<TARGET_FILE:pwlsim_library>)
endif()
