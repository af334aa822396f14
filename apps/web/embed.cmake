# Makes one page of the files in FOLDER, and a source of it: cmake -DFOLDER=... -DOUT=... -P embed.cmake
# Each <!-- embed FILE --> of index.html becomes that file.
file(READ ${FOLDER}/index.html page)
string(REGEX MATCHALL "<!-- embed [^ ]+ -->" marks "${page}")
foreach(mark ${marks})
  string(REGEX REPLACE "<!-- embed ([^ ]+) -->" "\\1" name "${mark}")
  file(READ ${FOLDER}/${name} text)
  string(FIND "${page}" "${mark}" at)
  string(LENGTH "${mark}" length)
  math(EXPR end "${at} + ${length}")
  string(SUBSTRING "${page}" 0 ${at} before)
  string(SUBSTRING "${page}" ${end} -1 after)
  set(page "${before}${text}${after}")
endforeach()
# As numbers, for a compiler may refuse a text of this length.
file(WRITE ${OUT}.html "${page}")
file(READ ${OUT}.html hex HEX)
string(REGEX REPLACE "(................................................................)" "\\1\n" hex "${hex}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," numbers "${hex}")
file(WRITE ${OUT} "#include <string_view>\n\nnamespace nendo::web {\nnamespace {\n\n"
  "const unsigned char bytes[] = {\n${numbers}};\n\n} // namespace\n\n"
  "std::string_view page() noexcept; // server_input.cpp\n"
  "std::string_view page() noexcept {\n  return {reinterpret_cast<const char*>(bytes), sizeof bytes};\n}\n\n"
  "} // namespace nendo::web\n")
