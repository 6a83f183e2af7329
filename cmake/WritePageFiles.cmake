# cmake -D FILES=a;b -D FILE=... -P WritePageFiles.cmake: a source with the content of files, each under its name.
set(delimiter "page_file")
set(content "#include <array>\n#include <string_view>\n#include <utility>\n\n#include \"page_files.hpp\"\n\nnamespace kluft {\n\n")
set(entries "")
set(count 0)
foreach(file IN LISTS FILES)
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" text)
  string(FIND "${text}" ")${delimiter}\"" found)
  if(NOT found EQUAL -1)
    message(FATAL_ERROR "${file}: expected no )${delimiter}\" in it")
  endif()
  string(APPEND entries "    std::pair<std::string_view, std::string_view>{\"${name}\", R\"${delimiter}(${text})${delimiter}\"},\n")
  math(EXPR count "${count} + 1")
endforeach()
string(APPEND content "namespace {\nconstexpr std::array<std::pair<std::string_view, std::string_view>, ${count}> page_files{{\n${entries}}};\n} // namespace\n\n"
  "std::string_view page_file(std::string_view name) {\n    for (const auto& [each, text] : page_files)\n"
  "        if (each == name) return text;\n    return {};\n}\n\n} // namespace kluft\n")
file(WRITE "${FILE}" "${content}")
