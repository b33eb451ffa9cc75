add_test(NAME cli COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_cli.py $<TARGET_FILE:sunder>)
set_tests_properties(cli PROPERTIES TIMEOUT 900)
add_test(NAME runs_cli COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_runs_cli.py $<TARGET_FILE:sunder>)
set_tests_properties(runs_cli PROPERTIES TIMEOUT 900)
