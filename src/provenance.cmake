# Writes OUTPUT from INPUT with the commit filled in. Run at every build, because the commit changes without
# CMake being run; the file is only touched when its content changes, so an unchanged build stays idle.
set(commit unknown)
set(tree "")
# git writes the commit here when it makes an archive, which has no other sign of it (.gitattributes). What was changed
# after unpacking cannot be told.
set(archived "$Format:%H$")
if(archived MATCHES "^[0-9a-f]+$")
  string(SUBSTRING ${archived} 0 12 commit)
  set(tree "$Format:%T$")
endif()
find_program(git git)
if(git)
  # The folder above may be another project's repository: only the source's own commit counts.
  execute_process(COMMAND ${git} rev-parse --show-toplevel WORKING_DIRECTORY ${SOURCE}
                  OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH "${SOURCE}" source)
  if(top STREQUAL source)
    execute_process(COMMAND ${git} rev-parse --short=12 HEAD WORKING_DIRECTORY ${SOURCE}
                    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
                    RESULT_VARIABLE failed)
    if(failed)
      set(commit unknown)
    else()
      execute_process(COMMAND ${git} rev-parse "HEAD^{tree}" WORKING_DIRECTORY ${SOURCE}
                      OUTPUT_VARIABLE tree OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      execute_process(COMMAND ${git} diff --quiet HEAD -- src CMakeLists.txt WORKING_DIRECTORY ${SOURCE}
                      RESULT_VARIABLE changed ERROR_QUIET)
      if(changed)
        string(APPEND commit -dirty)
        set(tree "")
      endif()
    endif()
  endif()
endif()
configure_file(${INPUT} ${OUTPUT} @ONLY)
