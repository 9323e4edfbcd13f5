#pragma once
// What a bench measured, in the one form of all results: tests/evaluation/results.schema.md.

#include <fstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace lpv::bench {

using Setting = std::variant<std::string, double, bool>;

struct Row {
  std::string name;      ///< "case" in the file: mesh, scene or load
  std::string quantity;  ///< what was measured; rows of one quantity make a table
  std::vector<std::pair<std::string, Setting>> settings;  ///< what decides the result
  std::vector<std::pair<std::string, double>> values;     ///< names tell the kind and unit, see results.schema.md
};

/// Prints rows as they come, tabs between columns, and appends them to a file, a JSON object a line.
class Rows {
 public:
  /// An empty `file`: only prints. Exits with a message where it cannot be written.
  /// `driver`: of the device that is measured.
  Rows(const std::string& file, const std::string& driver);
  void add(const Row& row);

 private:
  std::ofstream file_;
  std::string header_;  ///< printed last
};

/// What --rows is told to be, the same in every bench.
inline constexpr const char* kRowsHelp = "Append the rows to this file, a JSON object a line";

/// Of an odd number the one in the middle.
double medianOf(std::vector<double> values);

}  // namespace lpv::bench
