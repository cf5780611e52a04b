# Writes OUTPUT, a C++ source that holds each of FILES (a comma-separated list) as bytes under its name with '.' as '_'.
string(REPLACE "," ";" files "${FILES}")
set(text "#include \"compare/report/sources.h\"\n\nnamespace flowrest::report::sources {\n")
foreach(file ${files})
  get_filename_component(name ${file} NAME)
  string(REPLACE "." "_" name ${name})
  file(READ ${file} bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND text "static const unsigned char ${name}_bytes[] = {${bytes}};\n"
    "std::string_view ${name}() {\n"
    "  return {reinterpret_cast<const char*>(${name}_bytes), sizeof ${name}_bytes};\n}\n")
endforeach()
string(APPEND text "}  // namespace flowrest::report::sources\n")
file(WRITE ${OUTPUT} "${text}")
