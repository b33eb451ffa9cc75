sunder_test(json tests/unit/test_json.c sunder_base)
sunder_test(frames tests/store/test_frames.c sunder_store)
sunder_test(checkpoints tests/store/test_checkpoints.c sunder_store)
sunder_test(store_faults tests/store/test_store_faults.c sunder_store)
sunder_test(ledger tests/store/test_ledger.c sunder_store)
sunder_test(ledger_print tests/store/test_ledger_print.c sunder_store)

# What other programs make of a run; needs ParaView, and is skipped without it.
add_executable(make_run tests/store/make_run.c)
target_link_libraries(make_run PRIVATE sunder_store)
add_test(NAME paraview COMMAND sh ${CMAKE_SOURCE_DIR}/tests/store/paraview_check.sh $<TARGET_FILE:make_run>)
set_tests_properties(paraview PROPERTIES LABELS long SKIP_RETURN_CODE 77 TIMEOUT 300)
