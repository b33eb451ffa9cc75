sunder_test(mesh ${CMAKE_SOURCE_DIR}/tests/unit/test_mesh.c sunder_geom)
sunder_test(fibre_fields ${CMAKE_SOURCE_DIR}/tests/verify/test_fibre_fields.c sunder_geom)
sunder_test(script_fields ${CMAKE_SOURCE_DIR}/tests/unit/test_script_fields.c sunder_script)
