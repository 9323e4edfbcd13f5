// Shadow rays between triangles (the product's: server/scene/triangle_bvh.h) against rays through a coverage grid at
// twice the volume's resolution (coverage_grid.h), in one run: errors of a penumbra, of bars, behind a wall and at the
// foot of a box, cost per ray, memory, and what making and moving takes. Prints Markdown.
//
//   visibility_bench [--repeats N] [--into FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy, LPV_BENCH_ROOM the glTF binary of the living room; bumpy
// spheres of as many triangles take their places.

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <sstream>

#include "reference/room.h"
#include "visibility_costs.h"

namespace {

using namespace lpv;
using namespace lpv::bench;

constexpr std::array<int, 2> kGrids = {32, 64};
constexpr int kSide = 8;  ///< 64 rays from a receiver
constexpr double kFlat = 0.0005;  ///< metres: depth of a bar of sheet metal
constexpr double kFeet[] = {0.02, 0.05, 0.1, 0.2};   ///< metres from the foot of a box
constexpr double kBehind[] = {0.05, 0.25, 1.0, 2.0};  ///< cells of the volume behind a wall

std::string text(const char* format, double value) {
  char out[32];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

std::string percent(double share) { return text(std::abs(share) < 0.0995 ? "%.1f" : "%.0f", 100.0 * share); }

/// As many digits as say something.
std::string number(double value) { return text(value < 1.0 ? "%.2f" : value < 10.0 ? "%.1f" : "%.0f", value); }

std::string mebibytes(std::size_t bytes) { return number(double(bytes) / (1 << 20)); }

using Tasks = std::vector<VisibilityTask>;

double meanTruth(const Tasks& tasks) {
  double sum = 0.0;
  for (const VisibilityTask& task : tasks)
    for (const double t : task.truth) sum += t / double(task.truth.size());
  return sum / double(tasks.size());
}

/// Of several tasks: means, and the largest.
VisibilityError together(const std::vector<VisibilityError>& errors) {
  VisibilityError out;
  for (const VisibilityError& e : errors) {
    out.mean += e.mean / double(errors.size());
    out.l2 += e.l2 / double(errors.size());
    out.rms += e.rms / double(errors.size());
    out.largestSeen = std::max(out.largestSeen, e.largestSeen);
    out.worst = std::max(out.worst, e.worst);
  }
  return out;
}

constexpr double kAskew[] = {0.0, 20.0};  ///< degrees from the grid's axes, of walls

Tasks behindWallOf(double cells, int grid, double degrees) { return {behindWall(cells * kTaskEdge / grid, degrees)}; }
Tasks atFeet(double metres) { return {atFoot(metres, 0.0), atFoot(metres, 17.0)}; }

class Comparison {
 public:
  Comparison(int repeats, std::ostream& out) : repeats_(repeats), out_(out) {
    lit_ = {penumbra(), bars(1.0), bars(0.05), bars(1.0, kFlat)};
    for (const double metres : kFeet) feet_.push_back(atFeet(metres));
  }

  void run() {
    variants();
    out_ << "\n| | true | triangles | grid for 32^3 | grid for 64^3 |\n|---|---|---|---|---|\n";
    litRows();
    wallRows();
    footRows();
    const std::array<std::vector<CostScene>, 2> scenes = {costScenes(kGrids[0]), costScenes(kGrids[1])};
    for (std::size_t i = 0; i < scenes[0].size(); ++i) rayRows({scenes[0][i], scenes[1][i]});
    for (std::size_t i = 0; i < scenes[0].size(); ++i) bytesRow({scenes[0][i], scenes[1][i]});
    for (std::size_t i = 0; i < scenes[0].size(); ++i) workRows({scenes[0][i], scenes[1][i]});
  }

 private:
  using ScenePair = std::array<CostScene, 2>;

  VisibilityError coverage(const Tasks& tasks, int cells, int side, const CoverageVariant& variant) {
    std::vector<VisibilityError> out;
    for (const VisibilityTask& task : tasks) out.push_back(ways_.byCoverage(task, cells, side, variant));
    return together(out);
  }

  /// By triangles, and by both grids in the way that was found best; `of` gives the tasks for a grid.
  template <typename TasksOf>
  std::array<VisibilityError, 3> all(const TasksOf& of, int side) {
    std::vector<VisibilityError> triangles;
    for (const VisibilityTask& task : of(kGrids[0])) triangles.push_back(ways_.byTriangles(task, kGrids[0], side));
    return {together(triangles), coverage(of(kGrids[0]), kGrids[0], side, variant_),
            coverage(of(kGrids[1]), kGrids[1], side, variant_)};
  }

  void row(const std::string& name, const std::string& truth, const std::array<std::string, 3>& values) {
    out_ << "| " << name << " | " << truth << " |";
    for (const std::string& value : values) out_ << " " << value << " |";
    out_ << std::endl;
  }

  template <typename Text>
  void row(const std::string& name, const std::string& truth, const std::array<VisibilityError, 3>& errors,
           const Text& textOf) {
    row(name, truth, {textOf(errors[0]), textOf(errors[1]), textOf(errors[2])});
  }

  /// All ways to use the grid; the one whose errors have the least sum is compared with triangles.
  void variants() {
    out_ << "| shares by; rays begin | penumbra | bars, lamp 1 m | bars, lamp 5 cm | behind a wall | foot of a box "
            "| sum | ns a ray |\n|---|---|---|---|---|---|---|---|\n";
    Tasks walls, feet;
    for (const double degrees : kAskew)
      for (const double cells : kBehind) walls.push_back(behindWallOf(cells, kGrids[0], degrees)[0]);
    for (const Tasks& tasks : feet_) feet.insert(feet.end(), tasks.begin(), tasks.end());
    const Scene room = reference::smallRoom(kGrids[0]);
    double least = std::numeric_limits<double>::infinity();
    for (const CoverageVariant& variant : coverageVariants()) {
      out_ << "| " << nameOf(variant) << " |";
      double sum = 0.0;
      for (const Tasks& tasks : {Tasks{lit_[0]}, Tasks{lit_[1]}, Tasks{lit_[2]}, walls, feet}) {
        const double rms = coverage(tasks, kGrids[0], kSide, variant).rms;
        out_ << " " << percent(rms) << " |";
        sum += rms;
      }
      const double ray = VisibilityCosts(ways_, variant, repeats_).ray(room, true).coverage;
      out_ << " " << percent(sum) << " | " << number(1e9 * ray) << " |" << std::endl;
      if (sum < least) variant_ = variant;
      least = std::min(least, sum);
    }
  }

  void litRows() {
    for (const VisibilityTask& task : lit_) {
      const Tasks tasks = {task};
      for (const int side : {4, kSide, 32}) {
        const auto errors = all([&](int) { return tasks; }, side);
        const std::string name = task.name + ", " + std::to_string(side * side) + " rays: ";
        row(name + "seen, mean %", percent(meanTruth(tasks)), errors,
            [](const VisibilityError& e) { return percent(e.mean); });
        row(name + "L2 (largest error) %", "", errors,
            [](const VisibilityError& e) { return percent(e.l2) + " (" + percent(e.worst) + ")"; });
      }
    }
  }

  void wallRows() {
    for (const double degrees : kAskew) {
      for (const double cells : kBehind) {
        const std::string wall = degrees == 0.0 ? " behind a closed wall along the axes" : " behind one that is askew";
        row("seen " + text("%g", cells) + (cells == 1.0 ? " cell" : " cells") + wall + ", mean (largest) %", "0",
            all([&](int grid) { return behindWallOf(cells, grid, degrees); }, kSide),
            [](const VisibilityError& e) { return percent(e.mean) + " (" + percent(e.largestSeen) + ")"; });
      }
    }
  }

  void footRows() {
    for (std::size_t i = 0; i < feet_.size(); ++i) {
      row("seen " + text("%g", 100.0 * kFeet[i]) + " cm from the foot of a box, mean (largest error) %",
          percent(meanTruth(feet_[i])), all([&](int) { return feet_[i]; }, kSide),
          [](const VisibilityError& e) { return percent(e.mean) + " (" + percent(e.worst) + ")"; });
    }
  }

  static std::string nameOfScene(const CostScene& scene) {
    return scene.name + ", " + std::to_string(scene.triangles) + " triangles";
  }

  /// `scale`: of the numbers that are shown.
  void costRow(const std::string& name, const std::array<Compared, 2>& costs, double scale) {
    const auto grid = [&](const Compared& c) {
      return number(scale * c.coverage) + " (" + number(c.coverage / c.triangles) + "x)";
    };
    row(name, "", {number(scale * costs[0].triangles), grid(costs[0]), grid(costs[1])});
  }

  void rayRows(const ScenePair& scenes) {
    for (const bool toLamp : {false, true}) {
      std::array<Compared, 2> costs;
      for (std::size_t i = 0; i < 2; ++i)
        costs[i] = VisibilityCosts(ways_, variant_, repeats_).ray(scenes[i].scene, toLamp);
      costRow("ns a ray " + std::string(toLamp ? "to the lamp" : "of 2 cells") + ": " + nameOfScene(scenes[0]), costs,
              1e9);
    }
  }

  void bytesRow(const ScenePair& scenes) {
    const VisibilityBytes bytes[] = {bytesOf(scenes[0].scene), bytesOf(scenes[1].scene)};
    const auto grid = [](const VisibilityBytes& b) {
      return mebibytes(b.coverage) + " (+ " + mebibytes(b.lines) + ")";
    };
    row("MiB: " + nameOfScene(scenes[0]), "", {mebibytes(bytes[0].triangles), grid(bytes[0]), grid(bytes[1])});
  }

  void workRows(const ScenePair& scenes) {
    VisibilityCosts costs(ways_, variant_, repeats_);
    costRow("ms to make: " + nameOfScene(scenes[0]), {costs.make(scenes[0].scene), costs.make(scenes[1].scene)}, 1e3);
    costRow("ms to move " + std::to_string(largestOf(scenes[0].scene)) + " triangles: " + scenes[0].name,
            {costs.move(scenes[0].scene), costs.move(scenes[1].scene)}, 1e3);
  }

  int repeats_;
  std::ostream& out_;
  VisibilityWays ways_;
  Tasks lit_;
  std::vector<Tasks> feet_;
  CoverageVariant variant_;
};

/// Everything that is written goes to both.
class Both : public std::streambuf {
 public:
  Both(std::streambuf* first, std::streambuf* second) : first_(first), second_(second) {}

 private:
  int overflow(int c) override {
    first_->sputc(char(c));
    return second_->sputc(char(c));
  }
  int sync() override { return first_->pubsync() + second_->pubsync(); }

  std::streambuf *first_, *second_;
};

/// Puts `part` between the comments <!-- visibility --> and <!-- /visibility --> of a file.
bool replacePart(const std::string& path, const std::string& part) {
  std::ifstream in(path);
  std::string all{std::istreambuf_iterator<char>(in), {}};
  const std::string begin = "<!-- visibility -->\n", end = "<!-- /visibility -->";
  const std::size_t from = all.find(begin), to = all.find(end);
  if (from == std::string::npos || to == std::string::npos) return false;
  const std::size_t at = from + begin.size();
  std::ofstream(path) << all.replace(at, to - at, part);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Shadow rays between triangles against a coverage grid"};
  int repeats = 9;
  std::string into;
  app.add_option("--repeats", repeats, "Measurements of each cost")->check(CLI::Range(1, 1000));
  app.add_option("--into", into, "Markdown file whose part between the \"visibility\" comments is replaced");
  CLI11_PARSE(app, argc, argv);
  const std::string device = deviceContext().capabilities().renderer;
  std::ostringstream kept;
  Both both(std::cout.rdbuf(), kept.rdbuf());
  std::ostream out(&both);
  out << "Device: " << device << "; costs are medians of " << repeats << ".\n\n";
  Comparison(repeats, out).run();
  if (into.empty() || replacePart(into, kept.str())) return 0;
  std::cerr << into << " does not have the two \"visibility\" comments\n";
  return 1;
}
