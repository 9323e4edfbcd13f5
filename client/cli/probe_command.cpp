// probe

#include <array>
#include <fstream>
#include <iostream>
#include <memory>

#include "command.h"
#include "lpv/convert.h"
#include "output.h"
#include "values.h"

namespace lpv::cli {
namespace {

struct ProbeOptions {
  std::string id;
  std::optional<glm::dvec3> at;
  std::optional<glm::dvec3> normal;
  std::string points;
  bool volumeOnly = false;
  bool around = false;
};

/// Reads lines x,y,z,nx,ny,nz. A first line of words is skipped as a heading, as are empty lines and lines with #.
Expected<std::vector<client::SurfacePoint>> readPoints(const std::string& path) {
  std::ifstream opened;
  if (path != "-") opened.open(path);
  std::istream& file = path == "-" ? std::cin : opened;
  if (!file) return localError("points", path + ": the file cannot be opened");
  std::vector<client::SurfacePoint> points;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    if (line.empty() || line[0] == '#') continue;
    const auto n = parseNumbers(line, {6});
    if (!n && number == 1) continue;
    if (!n)
      return localError("points", path + ": line " + std::to_string(number) + " must be six numbers x,y,z,nx,ny,nz");
    points.push_back({{(*n)[0], (*n)[1], (*n)[2]}, {(*n)[3], (*n)[4], (*n)[5]}});
  }
  if (points.empty()) return localError("points", path + ": the file has no points");
  return points;
}

std::string joined(const std::vector<double>& numbers, char separator) {
  std::string out;
  for (const double number : numbers) out += (out.empty() ? "" : std::string(1, separator)) + numberText(number);
  return out;
}

std::vector<double> numbersOf(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

/// Main light, back faces and harmonics, as columns.
std::vector<double> numbersOf(const client::LightAround& around) {
  std::vector<double> out = numbersOf(around.mainDirection);
  for (const double number : numbersOf(around.mainIrradiance)) out.push_back(number);
  out.push_back(around.backFaces);
  for (const glm::vec3& harmonic : around.harmonics) {
    for (const double number : numbersOf(glm::dvec3(harmonic))) out.push_back(number);
  }
  return out;
}

/// One line of the CSV. Points outside the volume get nan.
std::string csvLine(const client::SurfacePoint& p, const client::ProbeResult& result, std::size_t i) {
  const Irradiance& answer = result.irradiance[i];
  std::string line = joined({p.position.x, p.position.y, p.position.z, p.normal.x, p.normal.y, p.normal.z}, ',') + ",";
  line += answer.valid ? joined(numbersOf(answer.rgb), ',') : "nan,nan,nan";
  return result.around.empty() ? line : line + "," + joined(numbersOf(result.around[i]), ',');
}

JsonObject jsonOf(const client::LightAround& around) {
  std::vector<double> harmonics;
  for (const glm::vec3& harmonic : around.harmonics) {
    for (const double number : numbersOf(glm::dvec3(harmonic))) harmonics.push_back(number);
  }
  return JsonObject()
      .vec3("mainDirection", around.mainDirection)
      .vec3("mainIrradiance", around.mainIrradiance)
      .number("backFaces", around.backFaces)
      .numbers("harmonics", harmonics);
}

std::string jsonPoint(const client::SurfacePoint& p, const client::ProbeResult& result, std::size_t i) {
  JsonObject out;
  out.vec3("position", p.position)
      .vec3("normal", p.normal)
      .vec3("irradiance", result.irradiance[i].rgb)
      .flag("valid", result.irradiance[i].valid);
  if (!result.around.empty()) out.raw("around", jsonOf(result.around[i]).str());
  return out.str();
}

void printJson(const std::vector<client::SurfacePoint>& points, const client::ProbeResult& result) {
  std::vector<std::string> items;
  for (std::size_t i = 0; i < points.size(); ++i) items.push_back(jsonPoint(points[i], result, i));
  print(JsonObject().raw("result", toJson(result.info)).raw("points", jsonArray(items)).str());
}

void printAround(const client::LightAround& around) {
  constexpr const char* kNames[] = {"00", "1-1", "10", "11", "2-2", "2-1", "20", "21", "22"};
  std::vector<std::vector<std::string>> rows = {{"main light from", joined(numbersOf(around.mainDirection), ' ')},
                                                {"main light", joined(numbersOf(around.mainIrradiance), ' ')},
                                                {"back faces", std::to_string(around.backFaces) + " of 64"}};
  for (std::size_t i = 0; i < around.harmonics.size(); ++i)
    rows.push_back({std::string("harmonic ") + kNames[i], joined(numbersOf(glm::dvec3(around.harmonics[i])), ' ')});
  printTable(rows);
}

std::string noAnswer(const client::ProbeResult& result) {
  constexpr int kInside = 16;
  const int backs = result.around.empty() ? 0 : result.around[0].backFaces;
  return backs < kInside
             ? "the point lies outside the session's grid"
             : "the point lies inside of a surface: " + std::to_string(backs) + " of 64 rays from it meet a back";
}

Status probe(Context& context, const ProbeOptions& options) {
  std::vector<client::SurfacePoint> points;
  if (options.points.empty()) {
    points.push_back({*options.at, *options.normal});
  } else {
    auto read = readPoints(options.points);
    if (!read) return read.status();
    points = std::move(*read);
  }
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const auto result = client->probe(options.id, points, {.volumeOnly = options.volumeOnly, .around = options.around});
  if (!result) return result.status();
  if (context.json()) {
    printJson(points, *result);
    return {};
  }
  if (!options.points.empty()) {
    for (std::size_t i = 0; i < points.size(); ++i) std::cout << csvLine(points[i], *result, i) << "\n";
    std::cout.flush();
    return {};
  }
  const Irradiance& answer = result->irradiance[0];
  if (!answer.valid) return Status(Code::kOutOfRange, noAnswer(*result), "at");
  print(joined(numbersOf(answer.rgb), ' '));
  if (options.around) printAround(result->around[0]);
  return {};
}

}  // namespace

void addProbeCommand(CLI::App& app, Commands& commands) {
  auto given = std::make_shared<ProbeOptions>();
  CLI::App& command = commands.add(app, "probe", "Print the irradiance at points: r g b, W/m^2",
                                   [given](Context& context) { return probe(context, *given); });
  addSession(command, given->id);
  auto* at = addVec3(command, "--at", given->at, "Position of one point, metres");
  auto* normal = addVec3(command, "--normal", given->normal, "Normal of the surface at that point")->needs(at);
  at->needs(normal);
  command.add_option("--points", given->points, "File of points, one line x,y,z,nx,ny,nz each; - reads stdin")
      ->type_name("FILE.csv")
      ->excludes(at);
  command.add_flag("--volume-only", given->volumeOnly, "Look the volume up only, without the near field");
  command.add_flag("--around", given->around,
                   "The light all around, too: main light and spherical harmonics up to band 2, as WebXR has them");
  command.parse_complete_callback([given] {
    if (!given->at && given->points.empty())
      throw CLI::ValidationError("probe", "give either --at and --normal, or --points");
  });
}

}  // namespace lpv::cli
