# Writes OUTPUT: a table of (path in PAGE_DIR, bytes) of everything in PAGE_DIR, which may be missing. The assembler takes the bytes from
# the files themselves.
file(GLOB_RECURSE files RELATIVE ${PAGE_DIR} ${PAGE_DIR}/*)
list(SORT files)
set(names)
set(bytes)
set(rows)
foreach(name ${files})
  list(LENGTH rows number)
  string(APPEND bytes "__asm__(\".pushsection .rodata\\n.hidden lpv_page_${number}\\n.hidden lpv_page_${number}_end\\n\"\n"
                      "        \".global lpv_page_${number}\\nlpv_page_${number}:\\n.incbin \\\"${PAGE_DIR}/${name}\\\"\\n\"\n"
                      "        \".global lpv_page_${number}_end\\nlpv_page_${number}_end:\\n.byte 0\\n.popsection\\n\");\n")
  string(APPEND names "extern const char lpv_page_${number}[], lpv_page_${number}_end[];\n")
  list(APPEND rows "    {\"${name}\", lpv_page_${number}, lpv_page_${number}_end},\n")
endforeach()
string(JOIN "" rows ${rows})
file(WRITE ${OUTPUT} "#include \"web/files.h\"\n\n${bytes}\nextern \"C\" {\n${names}}\n\nnamespace lpv::web_door {\n\n"
                     "const EmbeddedFile kEmbeddedFiles[] = {\n${rows}    {nullptr, nullptr, nullptr},\n};\n\n}  // namespace lpv::web_door\n")
