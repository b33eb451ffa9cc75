# What `sunder bench` promises of its output; how fast anything is, is nobody's test.
add_test(NAME bench COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_bench.py $<TARGET_FILE:sunder>)
set_tests_properties(bench PROPERTIES TIMEOUT 900)
