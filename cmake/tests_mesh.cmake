sunder_test(mesh ${CMAKE_SOURCE_DIR}/tests/unit/test_mesh.c sunder_geom)
