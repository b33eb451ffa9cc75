# The verification of the sheet engine.
foreach(name sheet_forces sheet_elastic sheet_diffusion sheet_fracture sheet_dynamics sheet_determinism sheet_multirate sheet_refresh sheet_trapping sheet_sph)
  sunder_test(${name} ${CMAKE_SOURCE_DIR}/tests/verify/test_${name}.c sunder_sheet)
endforeach()

add_test(NAME sheet_scenes COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_sheet_scenes.py $<TARGET_FILE:sunder>)
set_tests_properties(sheet_scenes PROPERTIES LABELS long TIMEOUT 600)

add_test(NAME both_kinds COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_both_kinds.py $<TARGET_FILE:sunder>)
set_tests_properties(both_kinds PROPERTIES TIMEOUT 300)
