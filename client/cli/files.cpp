#include "files.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>

namespace lpv::cli {

Status writeFile(const std::string& path, const std::string& bytes) {
  if (isStandardStream(path)) {
    std::cout.write(bytes.data(), std::streamsize(bytes.size())).flush();
    return std::cout ? Status()
                     : localError("output", "stdout cannot be written: its reader has gone, or its disk is full");
  }
  const std::string partial = path + ".part";
  std::ofstream file(partial, std::ios::binary);
  file.write(bytes.data(), std::streamsize(bytes.size()));
  file.close();
  if (file && std::rename(partial.c_str(), path.c_str()) == 0) return {};
  std::remove(partial.c_str());
  return localError("output", "cannot write " + path);
}

Expected<std::string> readFile(const std::string& path, const std::string& field) {
  std::ifstream opened;
  if (!isStandardStream(path)) opened.open(path, std::ios::binary);
  std::istream& file = isStandardStream(path) ? std::cin : opened;
  if (!file) return localError(field, path + ": the file cannot be opened");
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

void checkBinaryOutput(const Context& context, const std::string& command, const std::string& path) {
  if (!isStandardStream(path)) return;
  if (context.json()) {
    failUsage(command, "--json prints an object on stdout, where - writes the file; name a file, or leave --json out");
  }
  if (isatty(STDOUT_FILENO) != 0) {
    failUsage(command, "- would write a binary file onto the terminal; send stdout to a file or a program");
  }
}

}  // namespace lpv::cli
