sunder_test(shape ${CMAKE_SOURCE_DIR}/tests/unit/test_shape.c sunder_geom)
sunder_test(sampling ${CMAKE_SOURCE_DIR}/tests/unit/test_sampling.c sunder_geom)
sunder_test(fibres ${CMAKE_SOURCE_DIR}/tests/unit/test_fibres.c sunder_geom)
sunder_test(tetrahedra ${CMAKE_SOURCE_DIR}/tests/unit/test_tetrahedra.c sunder_geom)
