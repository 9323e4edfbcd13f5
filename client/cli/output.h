#pragma once
// Prints results to stdout: messages as proto JSON, other results as small JSON objects, tables for people.

#include <google/protobuf/message.h>

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace lpv::cli {

/// A message as proto JSON in one line; fields with default values are printed too.
std::string toJson(const google::protobuf::Message& message);

/// Writes a JSON object with its fields in the order added. Numbers that are not finite become null.
class JsonObject {
 public:
  JsonObject& text(const std::string& key, const std::string& value);
  JsonObject& number(const std::string& key, double value);
  JsonObject& flag(const std::string& key, bool value);
  JsonObject& numbers(const std::string& key, const std::vector<double>& values);
  JsonObject& vec3(const std::string& key, const glm::dvec3& value);
  /// Adds a value that already is JSON.
  JsonObject& raw(const std::string& key, const std::string& json);
  std::string str() const { return "{" + body_ + "}"; }

 private:
  std::string body_;
};

/// A JSON array of values that already are JSON.
std::string jsonArray(const std::vector<std::string>& values);

/// What a terminal may be shown of a text that a server sent: hidden characters (base/text.h), line ends too, as
/// escapes that JSON reads back.
std::string visible(const std::string& text);

/// Prints a line on stdout, visible(), and flushes.
void print(const std::string& line);

/// The shortest text that reads back as the same double.
std::string numberText(double value);

/// At most six significant digits.
std::string shortText(double value);

/// Prints rows with each column padded to its widest cell, two spaces between columns.
void printTable(const std::vector<std::vector<std::string>>& rows);

}  // namespace lpv::cli
