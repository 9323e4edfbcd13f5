#include "gpu/shader_record.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

namespace lpv::gpu {

namespace {

std::string recordName(const std::string& file, const std::string& text) {
  const std::filesystem::path entry(file);
  std::string stem = (entry.parent_path() / entry.stem()).string();
  std::replace(stem.begin(), stem.end(), '/', '_');
  return fmt::format("{}.{:016x}{}", stem, std::hash<std::string>()(text), entry.extension().string());
}

}  // namespace

void recordShader(const std::string& file, const std::string& text) {
  const char* const folder = std::getenv("LPV_SHADER_RECORD");
  if (folder == nullptr || *folder == '\0') return;
  const std::filesystem::path record = std::filesystem::path(folder) / recordName(file, text);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (std::filesystem::exists(record, error)) return;
  // Under another name first: a process that is compiling the same variant sees a whole record or none.
  std::filesystem::path part = record;
  part += "." + std::to_string(getpid());
  std::ofstream out(part, std::ios::binary);
  out << text;
  out.close();
  if (out) std::filesystem::rename(part, record, error);
  if (!out || error) spdlog::warn("LPV_SHADER_RECORD: {} cannot be written", record.string());
}

}  // namespace lpv::gpu
