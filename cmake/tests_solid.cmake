# The verification of the solid engine. Point tests include the engine's own effect sources through their f64 plain build.
foreach(name constitutive damage damage_grid variation transfer contact tension determinism builds step_limit)
  sunder_test(${name} ${CMAKE_SOURCE_DIR}/tests/verify/test_${name}.c sunder_sim)
endforeach()
sunder_test(inextensible ${CMAKE_SOURCE_DIR}/tests/verify/test_inextensible.c sunder_sim)
