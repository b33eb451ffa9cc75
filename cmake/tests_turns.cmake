# Knobs, turns, branches: what makes a run that was tuned by hand one that can be done again.
sunder_test(knobs ${CMAKE_SOURCE_DIR}/tests/verify/test_knobs.c sunder_sim)
sunder_test(session ${CMAKE_SOURCE_DIR}/tests/session/test_session.c sunder_session)
add_test(NAME turns COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_turns.py $<TARGET_FILE:sunder>)
set_tests_properties(turns PROPERTIES TIMEOUT 600)
