# cmake -DOUT=file.cpp -DROOT=dir -DFILES=a;b -P embed.cmake: the page's files as one array of (name, text).
set(text "#include \"apps/view/http.h\"\nnamespace kdray::view {\nstatic const PageFile kFiles[] = {\n")
foreach(file IN LISTS FILES)
  file(READ "${ROOT}/${file}" content)
  string(APPEND text "{\"/${file}\", R\"kdraypage(${content})kdraypage\"},\n")
endforeach()
string(APPEND text "};\nstd::span<const PageFile> page_files() { return kFiles; }\n}  // namespace kdray::view\n")
file(WRITE "${OUT}" "${text}")
