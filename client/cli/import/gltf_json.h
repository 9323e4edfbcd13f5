#pragma once
// Reads the JSON of a glTF file with the types that glTF 2.0 asks for, and says where one is wrong.

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::cli {

/// INVALID_ARGUMENT, with the line, for text that is no JSON or is nested deeper than 128 levels.
Expected<nlohmann::json> parseJson(std::string_view text);

/// A value of a glTF file and where it is ("meshes[0].primitives"). Reading never fails: what is absent or wrong reads
/// as the default, and the first wrong value goes into the Status that all places of a file share.
class JsonPlace {
 public:
  JsonPlace(const nlohmann::json& root, Status& problem) : value_(&root), problem_(&problem) {}

  bool present() const { return value_ != nullptr; }
  const std::string& name() const { return name_; }

  JsonPlace at(const char* key) const;        ///< member of an object; absent if there is none
  JsonPlace at(std::size_t index) const;      ///< element of an array; absent beyond its end
  std::size_t size() const;                   ///< of an array; 0 if absent

  std::string text() const;
  double number(double otherwise) const;
  bool flag() const;
  std::size_t whole(std::size_t otherwise) const;  ///< a number without sign and fraction, below 2^53
  /// A whole number below `count`, which is the number of `things` in the file; none if absent or out of range.
  std::optional<std::size_t> index(std::size_t count, const char* things) const;

  /// Keeps "NAME: what" as the file's problem unless it has one already.
  void refuse(const std::string& what) const;

 private:
  JsonPlace(const nlohmann::json* value, std::string name, Status* problem)
      : value_(value), name_(std::move(name)), problem_(problem) {}
  bool is(bool right, const char* wanted) const;

  const nlohmann::json* value_;
  std::string name_;
  Status* problem_;
};

/// Copies the array `key` of exactly `size` numbers; nothing if the member is absent.
void copyNumbers(const JsonPlace& from, const char* key, std::size_t size, nlohmann::json& to);

}  // namespace lpv::cli
