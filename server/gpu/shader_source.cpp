#include "gpu/shader_source.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "gpu/failure.h"

namespace lpv::gpu {

namespace {

Defines& deviceDefines() {
  thread_local Defines defines;
  return defines;
}

std::string readShader(const std::string& name) {
#ifdef LPV_SHADER_DIR
  std::ifstream file(std::filesystem::path(LPV_SHADER_DIR) / name);
  if (!file) throw Failure(Code::kInternal, "there is no shader source " + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
#else
  for (const EmbeddedShader* entry = kEmbeddedShaders; entry->name != nullptr; ++entry) {
    if (name == entry->name) return entry->text;
  }
  throw Failure(Code::kInternal, "there is no shader source " + name);
#endif
}

/// The quoted name of an #include line, or empty.
std::string includedFile(const std::string& line) {
  const auto hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line.compare(hash, 8, "#include") != 0) return {};
  const auto open = line.find('"', hash);
  const auto close = open == std::string::npos ? open : line.find('"', open + 1);
  return close == std::string::npos ? std::string() : line.substr(open + 1, close - open - 1);
}

void appendFile(const std::string& name, ShaderSource& out);

void appendText(const std::string& name, const std::string& text, ShaderSource& out) {
  const std::size_t number = out.files.size();
  out.files.push_back(name);
  std::istringstream lines(text);
  out.text += "#line 1 " + std::to_string(number) + "\n";
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    ++count;
    const std::string include = includedFile(line);
    if (include.empty()) {
      out.text += line + "\n";
      continue;
    }
    appendFile(include, out);
    out.text += "#line " + std::to_string(count + 1) + " " + std::to_string(number) + "\n";
  }
}

void appendFile(const std::string& name, ShaderSource& out) {
  if (std::find(out.files.begin(), out.files.end(), name) == out.files.end()) appendText(name, readShader(name), out);
}

}  // namespace

Defines defineForDevice(Defines defines) { return std::exchange(deviceDefines(), std::move(defines)); }

ShaderSource assembleShader(const std::string& file, const Defines& defines) {
  return assembleText(file, readShader(file), defines);
}

ShaderSource assembleText(const std::string& name, const std::string& text, const Defines& defines) {
  ShaderSource source;
  source.text = "#version 450 core\n";
  for (const auto& [key, value] : deviceDefines()) source.text += "#define " + key + " " + value + "\n";
  for (const auto& [key, value] : defines) source.text += "#define " + key + " " + value + "\n";
  appendText(name, text, source);
  return source;
}

std::size_t sourceStamp([[maybe_unused]] const std::vector<std::string>& files) {
#ifdef LPV_SHADER_DIR
  std::size_t stamp = 0;
  for (const std::string& file : files) {
    std::error_code ignored;
    const auto time = std::filesystem::last_write_time(std::filesystem::path(LPV_SHADER_DIR) / file, ignored);
    stamp = stamp * 1000003u + std::size_t(time.time_since_epoch().count());
  }
  return stamp;
#else
  return 0;
#endif
}

}  // namespace lpv::gpu
