# Included by CMake at the end of project(): of the code that rosidl generates, only what a Python node loads.
#
# ament keeps the generators that packages have registered in one variable. Those for C++ are taken out of it as they
# come: no Python node loads what they make. Introspection for C stays: Fast DDS describes each topic's type with it.
function(_only_python variable access value)
  if(access STREQUAL "MODIFIED_ACCESS" AND value MATCHES "_cpp:")
    list(FILTER value EXCLUDE REGEX "_cpp:")
    set(${variable} "${value}" PARENT_SCOPE)
  endif()
endfunction()
variable_watch(AMENT_EXTENSIONS_rosidl_generate_idl_interfaces _only_python)

# The wheels of ROS name folders with headers of the machine on which they were made, and CMake stops at a folder that
# does not exist. The set-up of a course repairs these names; elsewhere, they are left out before CMake looks.
function(_only_existing_headers)
  get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(folders ${target} INTERFACE_INCLUDE_DIRECTORIES)
    if(folders)
      list(FILTER folders EXCLUDE REGEX "^/opt/python/")
      set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${folders}")
    endif()
  endforeach()
endfunction()
cmake_language(DEFER CALL _only_existing_headers)
