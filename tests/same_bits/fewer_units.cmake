# Included by CMake right after project() (CMAKE_PROJECT_INCLUDE): the sources that spend their time on reading
# the same large headers are compiled together. It halves the work of a build, and nothing but that.
function(compile_together)
  set_target_properties(impact-damper PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
  set_target_properties(impact_damper PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  foreach(group IN ITEMS "json;files/json_parser.cpp;files/json_reader.cpp"
                         "eigen;analysis/theory_forced.cpp;motion/contact_factors.cpp")
    list(POP_FRONT group name)
    list(TRANSFORM group PREPEND ${PROJECT_SOURCE_DIR}/src/impact_damper/)
    set_source_files_properties(${group} TARGET_DIRECTORY impact_damper PROPERTIES UNITY_GROUP ${name})
  endforeach()
endfunction()
cmake_language(DEFER CALL compile_together)
