#pragma once
// Parses values of command line options: "1,2,3", "640x360", "on". A value that cannot be parsed is a usage error.

#include <CLI/CLI.hpp>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lpv::cli {

/// Numbers separated by commas. Empty unless there are as many as one of `counts` says and nothing else.
std::optional<std::vector<double>> parseNumbers(const std::string& text, const std::vector<std::size_t>& counts);

/// Parses "WxH", whole pixels.
std::optional<glm::ivec2> parseSize(const std::string& text);

/// Parses "90", "90s", "10m", "1h", "2d" or "0" into seconds.
std::optional<double> parseDuration(const std::string& text);

/// Adds an option whose value is "x,y,z".
CLI::Option* addVec3(CLI::App& app, const std::string& name, std::optional<glm::dvec3>& value,
                     const std::string& about);
/// Adds an option whose value is "s" or "x,y,z".
CLI::Option* addScale(CLI::App& app, const std::string& name, std::optional<glm::dvec3>& value,
                      const std::string& about);
/// Adds an option whose value is "on" or "off".
CLI::Option* addSwitch(CLI::App& app, const std::string& name, std::optional<bool>& value, const std::string& about);

/// Adds an option whose value is one of the given words.
template <typename T>
CLI::Option* addChoice(CLI::App& app, const std::string& name, std::optional<T>& value,
                       const std::vector<std::pair<std::string, T>>& choices, const std::string& about) {
  std::string words;
  for (const auto& choice : choices) words += (words.empty() ? "" : "|") + choice.first;
  return app
      .add_option_function<std::string>(
          name,
          [&value, choices, name, words](const std::string& text) {
            for (const auto& [word, meaning] : choices) {
              if (text == word) value = meaning;
            }
            if (!value) throw CLI::ValidationError(name, "is '" + text + "'; allowed are " + words);
          },
          about)
      ->type_name(words);
}

/// Adds an option whose text `read` parses; `read` returns nothing for text it refuses. `form`: the expected form.
template <typename T>
CLI::Option* addParsed(CLI::App& app, const std::string& name, std::optional<T>& value, const std::string& form,
                       const std::function<std::optional<T>(const std::string&)>& read, const std::string& about) {
  return app
      .add_option_function<std::string>(
          name,
          [&value, name, form, read](const std::string& text) {
            value = read(text);
            if (!value) throw CLI::ValidationError(name, "is '" + text + "'; expected " + form);
          },
          about)
      ->type_name(form);
}

}  // namespace lpv::cli
