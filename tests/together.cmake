# Writes one source that includes several, each in a namespace of its own, after all headers that any of them includes:
#
#   cmake -DSOURCES=a.cpp;b.cpp -DOUTPUT=ab.cpp -P together.cmake
set(headers)
set(parts)
foreach(source IN LISTS SOURCES)
  file(STRINGS ${source} includes REGEX "^#include ")
  list(APPEND headers ${includes})
  get_filename_component(name ${source} NAME_WE)
  string(APPEND parts "\nnamespace test_${name} {\n#include \"${source}\"\n}\n")
endforeach()
list(REMOVE_DUPLICATES headers)
list(JOIN headers "\n" headers)
file(WRITE ${OUTPUT} "${headers}\n${parts}")
