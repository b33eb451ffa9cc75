sunder_test(script tests/unit/test_script.c sunder_script)
sunder_test(script_wrong tests/unit/test_script_wrong.c sunder_script)
sunder_test(script_strings tests/unit/test_script_strings.c sunder_script)
sunder_test(sweep_line tests/unit/test_sweep_line.c sunder_script)
sunder_test(console tests/unit/test_console.c sunder_script)
# Scenes that would never end: a sandbox that lets one through must not hang the suite.
set_tests_properties(script script_wrong script_strings PROPERTIES TIMEOUT 300)
