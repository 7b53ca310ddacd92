# One program a left-out effect, and one with all of them: for absent_effects.sh (ninja bench_absent_effects).
# Of an effect that is a folder the program gets a list of effects without it; of the others those files of the engines that know the effect are
# compiled again. The linker takes these before the library's.
set(engine_files ${CMAKE_SOURCE_DIR}/framework/engines)
set(collision_files stepping/moving_world contact/world_step rd/retroactive rd/recorder)
set(contact_files stepping/moving_world contact/world_step rd/retroactive rd/recorder)
set(friction_files contact/contact_geometry contact/sequential_impacts rd/retroactive)
set(callback_files events/advancement events/ordered)
set(sleep_files stepping/moving_world stepping/path_turning rd/retroactive contact/impact_detection contact/world_step rd/recorder contact/persistent_contacts contact/contact_steps contact/contact_activation contact/contact_modes contact/sequential_impacts contact/sleeping)

function(absent_effect_program name)
  add_executable(${name} EXCLUDE_FROM_ALL absent_effects.cpp ${ARGN})
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)   # files of another folder: how they are grouped there is not known here
  target_link_options(${name} PRIVATE -Wl,--allow-multiple-definition)   # the library's files come in groups, with copies of these; the first counts
  target_include_directories(${name} PRIVATE ${CMAKE_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE tumble::assignments tumble::engines tumble::test_laws tumble::test_places fmt::fmt)
  add_dependencies(${name} a1_reference a2_reference a3_reference)
  add_dependencies(bench_absent_effects ${name})
endfunction()

add_custom_target(bench_absent_effects)
absent_effect_program(bench_all_effects)
get_property(folders GLOBAL PROPERTY TUMBLE_EFFECTS)
foreach(effect ${folders})
  set(effects_list ${CMAKE_BINARY_DIR}/generated/effects/all_effects_without_${effect}.cpp)
  tumble_effects_list(${effects_list} WITHOUT ${effect})
  absent_effect_program(bench_without_${effect} ${effects_list})
endforeach()
foreach(effect collision contact friction sleep callback)
  list(TRANSFORM ${effect}_files REPLACE "(.+)" "${engine_files}/\\1.cpp" OUTPUT_VARIABLE files)
  absent_effect_program(bench_without_${effect} ${files})
  target_compile_definitions(bench_without_${effect} PRIVATE TUMBLE_WITHOUT="${effect}")
endforeach()
