add_test(NAME scenes COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_scenes.py $<TARGET_FILE:sunder> ${CMAKE_SOURCE_DIR})
set_tests_properties(scenes PROPERTIES LABELS long TIMEOUT 1200)
