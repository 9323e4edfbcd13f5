#include "import/gltf_json.h"

#include <algorithm>
#include <cmath>

namespace lpv::cli {
namespace {

using nlohmann::json;

constexpr int kDeepest = 128;

/// Builds the value, but not deeper than kDeepest levels: writing and destroying one is recursive.
class LimitedDepth : public json::json_sax_t {
 public:
  explicit LimitedDepth(json& out) : dom_(out, false) {}
  bool null() override { return dom_.null(); }
  bool boolean(bool value) override { return dom_.boolean(value); }
  bool number_integer(number_integer_t value) override { return dom_.number_integer(value); }
  bool number_unsigned(number_unsigned_t value) override { return dom_.number_unsigned(value); }
  bool number_float(number_float_t value, const string_t& text) override { return dom_.number_float(value, text); }
  bool string(string_t& value) override { return dom_.string(value); }
  bool binary(binary_t& value) override { return dom_.binary(value); }
  bool start_object(std::size_t size) override { return deeper() && dom_.start_object(size); }
  bool end_object() override { return --depth_, dom_.end_object(); }
  bool key(string_t& value) override { return dom_.key(value); }
  bool start_array(std::size_t size) override { return deeper() && dom_.start_array(size); }
  bool end_array() override { return --depth_, dom_.end_array(); }
  bool parse_error(std::size_t at, const std::string&, const nlohmann::detail::exception&) override {
    position = at;
    return false;
  }

  std::size_t position = 0;  ///< of a syntax error, in bytes
  bool tooDeep() const { return depth_ > kDeepest; }

 private:
  bool deeper() { return ++depth_ <= kDeepest; }
  nlohmann::detail::json_sax_dom_parser<json> dom_;
  int depth_ = 0;
};

}  // namespace

Expected<json> parseJson(std::string_view text) {
  json out;
  LimitedDepth sax(out);
  if (json::sax_parse(text.begin(), text.end(), &sax)) return out;
  if (sax.tooDeep())
    return invalid("file", "its JSON is nested deeper than " + std::to_string(kDeepest) +
                               " levels, the most that are read; export it without such extras");
  const std::string_view before = text.substr(0, sax.position);
  return invalid("file", "line " + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ", byte " +
                             std::to_string(sax.position) +
                             ": its JSON is malformed or cut short; copy or export the file again");
}

void JsonPlace::refuse(const std::string& what) const {
  if (problem_->ok()) *problem_ = invalid("file", name_ + (name_.empty() ? "" : " ") + what);
}

bool JsonPlace::is(bool right, const char* wanted) const {
  if (!right)
    refuse(std::string("is of type ") + value_->type_name() + ", glTF 2.0 asks for " + wanted +
           "; export the file again");
  return right;
}

JsonPlace JsonPlace::at(const char* key) const {
  std::string name = name_.empty() ? key : name_ + "." + key;
  if (value_ == nullptr || !is(value_->is_object(), "an object")) return {nullptr, std::move(name), problem_};
  const auto found = value_->find(key);
  return {found == value_->end() ? nullptr : &*found, std::move(name), problem_};
}

JsonPlace JsonPlace::at(std::size_t index) const {
  return {index < size() ? &(*value_)[index] : nullptr, name_ + "[" + std::to_string(index) + "]", problem_};
}

std::size_t JsonPlace::size() const {
  return value_ != nullptr && is(value_->is_array(), "an array") ? value_->size() : 0;
}

std::string JsonPlace::text() const {
  return value_ != nullptr && is(value_->is_string(), "a string") ? value_->get<std::string>() : std::string();
}

double JsonPlace::number(double otherwise) const {
  return value_ != nullptr && is(value_->is_number(), "a number") ? value_->get<double>() : otherwise;
}

bool JsonPlace::flag() const {
  return value_ != nullptr && is(value_->is_boolean(), "true or false") && value_->get<bool>();
}

std::size_t JsonPlace::whole(std::size_t otherwise) const {
  if (value_ == nullptr || !is(value_->is_number(), "a number")) return otherwise;
  const auto value = value_->get<double>();
  if (value >= 0.0 && value < 9007199254740992.0 && value == std::floor(value)) return std::size_t(value);
  refuse("is " + value_->dump() + ", glTF 2.0 asks for a whole number from 0; export the file again");
  return otherwise;
}

std::optional<std::size_t> JsonPlace::index(std::size_t count, const char* things) const {
  if (value_ == nullptr) return {};
  const std::size_t value = whole(count);
  if (value < count) return value;
  refuse("is " + value_->dump() + ", but the file has " + std::to_string(count) + " " + things +
         ", numbered from 0; export it again");
  return {};
}

void copyNumbers(const JsonPlace& from, const char* key, std::size_t size, json& to) {
  const JsonPlace place = from.at(key);
  if (!place.present()) return;
  if (place.size() != size) {
    return place.refuse("has " + std::to_string(place.size()) + " numbers, glTF 2.0 asks for " + std::to_string(size));
  }
  json& out = to[key] = json::array();
  for (std::size_t i = 0; i < size; ++i) out.push_back(place.at(i).number(0.0));
}

}  // namespace lpv::cli
