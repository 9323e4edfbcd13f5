#pragma once

#include <map>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::web_door {

/// A file that browsers get.
struct File {
  std::string type;         ///< "text/html; charset=utf-8"
  std::string_view plain;   ///< its bytes
  std::string_view packed;  ///< by gzip; empty where that was not made
  bool named = false;       ///< its name says what is in it, so that it may be kept for ever
};

/// The page, as client/web makes it.
class Files {
 public:
  /// What is part of this program; without the page where that was built without it.
  static Files embedded();
  /// A folder instead, read once: for those who work on the page. INVALID_ARGUMENT at web-files where it cannot be read
  /// or has no index.html.
  static Expected<Files> of(const std::string& folder);

  /// By the path of an address, "/" for the document; null where there is none.
  const File* at(const std::string& path) const;
  bool hasPage() const { return at("/") != nullptr; }

  Files(Files&&) = default;
  Files& operator=(Files&&) = default;

 private:
  Files() = default;
  /// `name`: in the folder, "assets/page-ABC.js".
  void add(const std::string& name, std::string_view bytes);

  std::map<std::string, std::string> owned_;  ///< bytes that are not part of the program
  std::map<std::string, File> files_;  ///< by path
};

/// A file that the build has put into the program; the list ends with one whose name is null.
struct EmbeddedFile {
  const char* name;
  const char* begin;
  const char* end;
};
extern const EmbeddedFile kEmbeddedFiles[];

}  // namespace lpv::web_door
