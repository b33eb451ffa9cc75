# tests/<folder>/test_<name>.c becomes one program and one CTest entry; link what it needs.
function(sunder_test name source)
  add_executable(test_${name} ${source})
  target_include_directories(test_${name} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  target_link_libraries(test_${name} PRIVATE ${ARGN})
  target_compile_definitions(test_${name} PRIVATE SUNDER_SOURCE="${CMAKE_SOURCE_DIR}" SUNDER_BINARY="${CMAKE_BINARY_DIR}")
  add_test(NAME ${name} COMMAND test_${name})
endfunction()

# Each floor lists its tests in a file of its own.
file(GLOB TEST_LISTS CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/tests_*.cmake)
foreach(list ${TEST_LISTS})
  include(${list})
endforeach()

# sunder_label(LABEL name…): of those that are built.
function(sunder_label label)
  foreach(name ${ARGN})
    if(TEST ${name})
      set_property(TEST ${name} APPEND PROPERTY LABELS ${label})
    endif()
  endforeach()
endfunction()

# Much arithmetic of code that other tests run too: with sanitizers, quarters of an hour each that find nothing more.
sunder_label(heavy sheet_fracture inextensible damage_grid)
# Threads share data: what ./dev test --tsan runs.
sunder_label(threads base determinism tetra_state knobs sheet_determinism sheet_multirate both_kinds session console turns tui tui_actions)
