#include "web/files.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace lpv::web_door {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDocument = "index.html";
constexpr const char* kPacked = ".gz";
/// Files whose names are made of their bytes.
constexpr const char* kNamedFolder = "assets/";

std::string typeOf(const std::string& name) {
  static constexpr std::array<std::pair<const char*, const char*>, 9> kTypes{{{".html", "text/html; charset=utf-8"},
                                                                              {".js", "text/javascript; charset=utf-8"},
                                                                              {".css", "text/css; charset=utf-8"},
                                                                              {".txt", "text/plain; charset=utf-8"},
                                                                              {".json", "application/json"},
                                                                              {".svg", "image/svg+xml"},
                                                                              {".png", "image/png"},
                                                                              {".wasm", "application/wasm"},
                                                                              {".woff2", "font/woff2"}}};
  for (const auto& [ending, type] : kTypes) {
    if (name.ends_with(ending)) return type;
  }
  return "application/octet-stream";
}

}  // namespace

void Files::add(const std::string& name, std::string_view bytes) {
  const bool packed = name.ends_with(kPacked);
  const std::string plain = packed ? name.substr(0, name.size() - std::string_view(kPacked).size()) : name;
  File& file = files_[plain == kDocument ? "/" : "/" + plain];
  file.type = typeOf(plain);
  file.named = plain.starts_with(kNamedFolder);
  (packed ? file.packed : file.plain) = bytes;
}

Files Files::embedded() {
  Files out;
  for (const EmbeddedFile* each = kEmbeddedFiles; each->name != nullptr; ++each)
    out.add(each->name, {each->begin, std::size_t(each->end - each->begin)});
  return out;
}

Expected<Files> Files::of(const std::string& folder) {
  Files out;
  std::error_code failed;
  for (fs::recursive_directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    if (!entry->is_regular_file()) continue;
    std::ifstream file(entry->path(), std::ios::binary);
    const std::string name = entry->path().lexically_relative(folder).generic_string();
    std::string& bytes = out.owned_[name];
    bytes.assign(std::istreambuf_iterator<char>(file), {});
    out.add(name, bytes);
  }
  if (failed) return invalid("web-files", "--web-files " + folder + " cannot be read: " + failed.message());
  if (out.hasPage()) return out;
  return invalid("web-files",
                 "--web-files " + folder + " has no index.html; give the folder that client/web was built to");
}

const File* Files::at(const std::string& path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace lpv::web_door
