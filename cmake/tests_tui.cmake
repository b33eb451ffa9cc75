# The screen's tests run it over a synthetic session: the tui library leaves session.h's functions to whoever links it.
sunder_test(view ${CMAKE_SOURCE_DIR}/tests/unit/test_view.c sunder_view)
sunder_test(view_scale ${CMAKE_SOURCE_DIR}/tests/unit/test_view_scale.c sunder_view)
sunder_test(typing ${CMAKE_SOURCE_DIR}/tests/unit/test_typing.c sunder_tui)
sunder_test(knob_panel ${CMAKE_SOURCE_DIR}/tests/unit/test_knob_panel.c sunder_tui sunder_sim)
sunder_test(pace ${CMAKE_SOURCE_DIR}/tests/unit/test_pace.c sunder_tui sunder_sim)
sunder_test(frame_reader ${CMAKE_SOURCE_DIR}/tests/store/test_frame_reader.c sunder_tui sunder_session)

add_executable(demo_tui ${CMAKE_SOURCE_DIR}/tests/tui/demo_tui.c ${CMAKE_SOURCE_DIR}/tests/tui/fake_session.c)
target_include_directories(demo_tui PRIVATE ${CMAKE_SOURCE_DIR}/tests)
target_link_libraries(demo_tui PRIVATE sunder_tui sunder_session sunder_sim)

find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  add_test(NAME tui COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tests/tui/test_tui.py $<TARGET_FILE:demo_tui>)
  set_tests_properties(tui PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 300)
endif()

# The program itself in terminals of its own: every action of every screen, and command logs done again to the same bits.
if(Python3_FOUND AND TARGET sunder)
  foreach(name actions manners replay)
    add_test(NAME tui_${name} COMMAND ${Python3_EXECUTABLE} ${CMAKE_SOURCE_DIR}/tests/tui/test_${name}.py $<TARGET_FILE:sunder> ${CMAKE_SOURCE_DIR}/scenes)
    set_tests_properties(tui_${name} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 900)
  endforeach()
endif()
