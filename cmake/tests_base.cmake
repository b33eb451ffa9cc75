sunder_test(base ${CMAKE_SOURCE_DIR}/tests/unit/test_base.c sunder_base)
add_test(NAME floors COMMAND bash ${CMAKE_SOURCE_DIR}/tests/unit/test_floors.sh ${CMAKE_SOURCE_DIR})
