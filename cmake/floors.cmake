# The floors, from the ground up: each has a CMakeLists.txt of its own and links only what lies below it.
set(SUNDER_FLOORS base geom effect solid sheet sim store script view session tui cli CACHE STRING "Floors to build: a developer of a low one need not build the rest")
foreach(floor ${SUNDER_FLOORS})
  if(EXISTS ${CMAKE_SOURCE_DIR}/src/${floor}/CMakeLists.txt)
    add_subdirectory(src/${floor})
  endif()
endforeach()
