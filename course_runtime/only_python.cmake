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
