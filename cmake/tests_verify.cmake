# Verification of the solid engine in whole bodies: dynamics with closed forms, and bodies of tetrahedra.
foreach(name manufactured vibration damage_lag tetra tetra_state piola solid_diffusion sheet_contact)
  sunder_test(${name} ${CMAKE_SOURCE_DIR}/tests/verify/test_${name}.c sunder_sim)
endforeach()
