#pragma once
// Results to stdout: messages as proto JSON, other facts as small JSON objects.

#include <google/protobuf/message.h>

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace lpv::cli {

/// A message as JSON in one line, all plain fields present.
std::string toJson(const google::protobuf::Message& message);

/// A JSON object, fields in the order added. Numbers that are not finite become null.
class JsonObject {
 public:
  JsonObject& text(const std::string& key, const std::string& value);
  JsonObject& number(const std::string& key, double value);
  JsonObject& flag(const std::string& key, bool value);
  JsonObject& numbers(const std::string& key, const std::vector<double>& values);
  JsonObject& vec3(const std::string& key, const glm::dvec3& value);
  /// `json` is JSON already.
  JsonObject& raw(const std::string& key, const std::string& json);
  std::string str() const { return "{" + body_ + "}"; }

 private:
  std::string body_;
};

/// "[a,b]" from JSON values.
std::string jsonArray(const std::vector<std::string>& values);

/// A line on stdout, at once.
void print(const std::string& line);

/// The shortest text that reads back as the same double.
std::string numberText(double value);

/// Six digits, for people.
std::string shortText(double value);

/// Columns padded to their widest cell, two spaces between.
void printTable(const std::vector<std::vector<std::string>>& rows);

}  // namespace lpv::cli
