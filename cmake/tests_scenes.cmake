# One entry a test of test_scenes.py, so that they run side by side and can be picked: ctest -R scenes_bone.
set(SCENE_TESTS ${CMAKE_SOURCE_DIR}/tests/cases/test_scenes.py)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${SCENE_TESTS})
file(STRINGS ${SCENE_TESTS} lines REGEX "^def test_")
foreach(line ${lines})
  string(REGEX REPLACE "^def test_([a-z_]+).*" "\\1" name ${line})
  add_test(NAME scenes_${name} COMMAND python3 ${SCENE_TESTS} $<TARGET_FILE:sunder> test_${name})
  set_tests_properties(scenes_${name} PROPERTIES LABELS long TIMEOUT 600)
endforeach()
