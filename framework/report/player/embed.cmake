# cmake -D OUT=file.cpp -D "FILES=a.js;b.css" -P embed.cmake: text files as string literals, so that the program needs no data folder.
set(text "// Made by framework/report/player/embed.cmake.\n#include \"framework/report/player_files.h\"\n\nnamespace tumble::report {\n\nstd::string_view player_file(std::string_view name) {\n")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} content)
  string(APPEND text "  if (name == \"${name}\") return R\"~~~~(${content})~~~~\";\n")
endforeach()
string(APPEND text "  return {};\n}\n\n}  // namespace tumble::report\n")
file(WRITE ${OUT} "${text}")
