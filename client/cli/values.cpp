#include "values.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lpv::cli {
namespace {

/// The number in `text`; empty unless all of the text is one number.
std::optional<double> parseNumber(const std::string& text) {
  double value = 0.0;
  const char* first = text.data() + (text.size() > 1 && text[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

std::optional<glm::dvec3> parseVec3(const std::string& text) {
  const auto n = parseNumbers(text, {3});
  if (!n) return {};
  return glm::dvec3((*n)[0], (*n)[1], (*n)[2]);
}

std::optional<glm::dvec3> parseScale(const std::string& text) {
  const auto n = parseNumbers(text, {1, 3});
  if (!n) return {};
  return n->size() == 1 ? glm::dvec3((*n)[0]) : glm::dvec3((*n)[0], (*n)[1], (*n)[2]);
}

}  // namespace

std::optional<std::vector<double>> parseNumbers(const std::string& text, const std::vector<std::size_t>& counts) {
  std::vector<double> numbers;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::optional<double> number = parseNumber(text.substr(begin, end - begin));
    if (!number) return {};
    numbers.push_back(*number);
    begin = end + 1;
  }
  if (std::find(counts.begin(), counts.end(), numbers.size()) == counts.end()) return {};
  return numbers;
}

std::optional<glm::ivec2> parseSize(const std::string& text) {
  glm::ivec2 size(0);
  const char* end = text.data() + text.size();
  const auto [cross, widthError] = std::from_chars(text.data(), end, size.x);
  if (widthError != std::errc() || cross == end || *cross != 'x') return {};
  const auto [rest, heightError] = std::from_chars(cross + 1, end, size.y);
  if (heightError != std::errc() || rest != end) return {};
  return size;
}

std::optional<double> parseDuration(const std::string& text) {
  if (text.empty()) return {};
  double unit = 1.0;
  std::string number = text;
  switch (text.back()) {
    case 's':
      break;
    case 'm':
      unit = 60.0;
      break;
    case 'h':
      unit = 3600.0;
      break;
    case 'd':
      unit = 86400.0;
      break;
    default:
      number += 's';
  }
  number.pop_back();
  const std::optional<double> value = parseNumber(number);
  if (!value || *value < 0.0) return {};
  return *value * unit;
}

CLI::Option* addVec3(CLI::App& app, const std::string& name, std::optional<glm::dvec3>& value,
                     const std::string& about) {
  return addParsed<glm::dvec3>(app, name, value, "x,y,z", parseVec3, about);
}

CLI::Option* addScale(CLI::App& app, const std::string& name, std::optional<glm::dvec3>& value,
                      const std::string& about) {
  return addParsed<glm::dvec3>(app, name, value, "s|x,y,z", parseScale, about);
}

CLI::Option* addSwitch(CLI::App& app, const std::string& name, std::optional<bool>& value, const std::string& about) {
  return addChoice<bool>(app, name, value, {{"on", true}, {"off", false}}, about);
}

}  // namespace lpv::cli
