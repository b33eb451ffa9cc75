# The hard cases, in pieces (one that ends the run names its cases), and the command that makes them.
if(TARGET sunder)
  add_test(NAME stress_command COMMAND python3 ${CMAKE_SOURCE_DIR}/tests/cases/test_stress.py $<TARGET_FILE:sunder>)
  set_tests_properties(stress_command PROPERTIES TIMEOUT 600)
  file(GLOB STRESS_SCENES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/scenes/stress/*.lua)
  foreach(scene ${STRESS_SCENES})
    get_filename_component(name ${scene} NAME_WE)
    add_test(NAME stress_${name} COMMAND sunder stress ${name} -j 1 --verbose)
    set_tests_properties(stress_${name} PROPERTIES TIMEOUT 600
      ENVIRONMENT "SUNDER_DB=${CMAKE_BINARY_DIR}/stress/${name}.db;XDG_DATA_HOME=${CMAKE_BINARY_DIR}/stress")
  endforeach()
endif()
