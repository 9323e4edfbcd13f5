#include "output.h"

#include <google/protobuf/util/json_util.h>

#include <array>
#include <charconv>
#include <cmath>
#include <iostream>

#include "base/text.h"

namespace lpv::cli {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      constexpr char kHex[] = "0123456789abcdef";
      out += std::string("\\u00") + kHex[(c >> 4) & 15] + kHex[c & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string jsonNumber(double value) { return std::isfinite(value) ? numberText(value) : "null"; }

}  // namespace

std::string toJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(message, &json, options);
  return status.ok() ? json : "{}";
}

JsonObject& JsonObject::raw(const std::string& key, const std::string& json) {
  if (!body_.empty()) body_ += ',';
  body_ += quoted(key);
  body_ += ':';
  body_ += json;
  return *this;
}

JsonObject& JsonObject::text(const std::string& key, const std::string& value) { return raw(key, quoted(value)); }

JsonObject& JsonObject::number(const std::string& key, double value) { return raw(key, jsonNumber(value)); }

JsonObject& JsonObject::flag(const std::string& key, bool value) { return raw(key, value ? "true" : "false"); }

JsonObject& JsonObject::numbers(const std::string& key, const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(jsonNumber(value));
  return raw(key, jsonArray(texts));
}

JsonObject& JsonObject::vec3(const std::string& key, const glm::dvec3& v) {
  return raw(key, JsonObject().number("x", v.x).number("y", v.y).number("z", v.z).str());
}

std::string jsonArray(const std::vector<std::string>& values) {
  std::string out = "[";
  for (const std::string& value : values) out += (out.size() > 1 ? "," : "") + value;
  return out + "]";
}

std::string visible(const std::string& text) { return withHiddenEscaped(text, "\t"); }

void print(const std::string& line) { std::cout << visible(line) << std::endl; }

std::string numberText(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), result.ptr);
}

std::string shortText(double value) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
  return std::string(text.data(), result.ptr);
}

void printTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], visible(row[i]).size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string cell = visible(row[i]);
      line += cell;
      if (i + 1 < row.size()) line.append(widths[i] - cell.size() + 2, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    print(line);
  }
}

}  // namespace lpv::cli
