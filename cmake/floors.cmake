# The floors, from the ground up: each has a CMakeLists.txt of its own and links only what lies below it.
foreach(floor base geom effect solid sim store script view session tui cli)
  if(EXISTS ${CMAKE_SOURCE_DIR}/src/${floor}/CMakeLists.txt)
    add_subdirectory(src/${floor})
  endif()
endforeach()
