# Accuracy and hard cases by figures made up for them.
sunder_test(study ${CMAKE_SOURCE_DIR}/tests/unit/test_study.c sunder_study)
# What accuracy costs: the command, over scenes whose orders are known.
if(TARGET sunder)
  add_test(NAME accuracy COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_accuracy.py $<TARGET_FILE:sunder>)
  set_tests_properties(accuracy PROPERTIES TIMEOUT 600)
endif()
