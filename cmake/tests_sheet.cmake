# The verification of the sheet engine.
foreach(name sheet_forces sheet_elastic sheet_diffusion sheet_fracture sheet_dynamics sheet_determinism)
  if(EXISTS ${CMAKE_SOURCE_DIR}/tests/verify/test_${name}.c)
    sunder_test(${name} ${CMAKE_SOURCE_DIR}/tests/verify/test_${name}.c sunder_sheet)
  endif()
endforeach()
