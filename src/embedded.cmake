# Writes OUTPUT: what the program needs of the files FILES, so that it stands alone wherever it is put.
# Each becomes the bytes of a string, called by the file's name.
file(WRITE ${OUTPUT}.new "#include \"files.hpp\"\n\nnamespace impact_damper::cli {\n\n")
file(APPEND ${OUTPUT}.new "const std::vector<EmbeddedFile>& embedded_files() {\n")
file(APPEND ${OUTPUT}.new "  static const std::vector<EmbeddedFile> files{\n")
foreach(path IN LISTS FILES)
  get_filename_component(name ${path} NAME)
  file(READ ${path} text)
  file(APPEND ${OUTPUT}.new "      {\"${name}\", R\"embedded(${text})embedded\"},\n")
endforeach()
file(APPEND ${OUTPUT}.new "  };\n  return files;\n}\n\n}  // namespace impact_damper::cli\n")
file(RENAME ${OUTPUT}.new ${OUTPUT})
