#include "bench/rows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

namespace lpv::bench {

namespace {

using Json = nlohmann::ordered_json;

Json asJson(const Setting& setting) {
  if (const auto* number = std::get_if<double>(&setting); number != nullptr && *number == std::floor(*number)) {
    return std::int64_t(*number);  // counts without a point
  }
  return std::visit([](const auto& value) { return Json(value); }, setting);
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string shown(const Setting& setting) {
  if (const auto* text = std::get_if<std::string>(&setting)) return *text;
  if (const auto* flag = std::get_if<bool>(&setting)) return *flag ? "yes" : "no";
  return shown(std::get<double>(setting));
}

std::string headerOf(const Row& row) {
  std::string out = row.quantity;
  for (const auto& [name, setting] : row.settings) out += "\t" + name;
  for (const auto& [name, value] : row.values) out += "\t" + name;
  return out;
}

}  // namespace

Rows::Rows(const std::string& file, const std::string& driver) {
  std::cout << driver << std::endl;
  if (file.empty()) return;
  file_.open(file, std::ios::app);
  file_ << Json{{"driver", driver}} << std::endl;
  if (file_) return;
  std::cerr << "--rows " << file << " cannot be written; name a file in a folder that is there\n";
  std::exit(1);
}

void Rows::add(const Row& row) {
  const std::string header = headerOf(row);
  if (header != header_) std::cout << "\n" << header << "\n";
  header_ = header;
  std::cout << row.name;
  Json settings = Json::object();
  Json values = Json::object();
  for (const auto& [name, setting] : row.settings) {
    std::cout << "\t" << shown(setting);
    settings[name] = asJson(setting);
  }
  for (const auto& [name, value] : row.values) {
    std::cout << "\t" << shown(value);
    values[name] = value;  // what is not finite becomes null
  }
  std::cout << std::endl;
  if (!file_.is_open()) return;
  file_ << Json{{"case", row.name}, {"quantity", row.quantity}, {"settings", settings}, {"values", values}}
        << std::endl;
}

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace lpv::bench
