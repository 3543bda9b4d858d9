# cmake -DOUT=file.cpp -DROOT=dir -DFILES=a;b -P embed.cmake: the kernel sources as one array of (name, text).
set(text "#include \"kernels.h\"\nnamespace kdray::kernels {\nstatic const Source kSources[] = {\n")
foreach(file IN LISTS FILES)
  file(READ "${ROOT}/${file}" content)
  string(APPEND text "{\"${file}\", R\"kdraysource(${content})kdraysource\"},\n")
endforeach()
string(APPEND text "};\nstd::span<const Source> sources() { return kSources; }\n}  // namespace kdray::kernels\n")
file(WRITE "${OUT}" "${text}")
