// volume get | info

#include <algorithm>
#include <cmath>
#include <memory>

#include "command.h"
#include "files.h"
#include "npy.h"
#include "output.h"
#include "progress.h"
#include "scene_flags.h"
#include "values.h"

namespace lpv::cli {
namespace {

struct VolumeOptions {
  std::string id;
  std::string out;
  std::optional<v1::VolumeStage> stage;
  std::optional<int> layer;
  bool layers = false;
  bool guard = false;
};

/// Shape of the array: (nz, ny, nx, 3, 4) of one layer or of the sum, (g, nz, ny, nx, 3, 4) with --layers.
struct Array {
  std::vector<std::size_t> shape;
  std::vector<float> values;
};

std::vector<float> sumOf(const Volume& volume) {
  std::vector<double> sum(volume.grid.cells() * 12, 0.0);
  for (const VolumeLayer& layer : volume.layers) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += layer.coefficients[i];
  }
  return {sum.begin(), sum.end()};
}

Expected<Array> arrayOf(const Volume& volume, const VolumeOptions& options) {
  const glm::ivec3 d = volume.grid.dims;
  Array out{{std::size_t(d.z), std::size_t(d.y), std::size_t(d.x), 3, 4}, {}};
  if (options.layers) {
    out.shape.insert(out.shape.begin(), volume.layers.size());
    for (const VolumeLayer& layer : volume.layers) {
      out.values.insert(out.values.end(), layer.coefficients.begin(), layer.coefficients.end());
    }
    return out;
  }
  if (!options.layer) {
    out.values = sumOf(volume);
    return out;
  }
  if (*options.layer < 0 || std::size_t(*options.layer) >= volume.layers.size()) {
    return localError("layer", "layer " + std::to_string(*options.layer) + " does not exist; the volume has " +
                                   std::to_string(volume.layers.size()));
  }
  out.values = volume.layers[std::size_t(*options.layer)].coefficients;
  return out;
}

std::string metadata(const VolumeOptions& options, const Array& array, const client::VolumeResult& result) {
  std::vector<double> shape(array.shape.begin(), array.shape.end());
  return JsonObject()
      .text("file", options.out)
      .numbers("shape", shape)
      .raw("header", toJson(result.header))
      .number("bytes", double(result.bytes))
      .str();
}

Expected<client::VolumeResult> fetch(Context& context, const VolumeOptions& options) {
  Expected<client::Client> client = context.connect();
  if (!client) return client.status();
  const Spinner spinner("waiting for the volume");
  v1::GetVolumeRequest request;
  request.set_session(options.id);
  request.set_stage(options.stage.value_or(v1::VOLUME_STAGE_TRANSPORTED));
  request.set_format(v1::VOLUME_FORMAT_FLOAT);
  request.set_guard_cells(options.guard ? kGuardCells : 0);
  return client->volume(request);
}

Status getVolume(Context& context, const VolumeOptions& options) {
  checkBinaryOutput(context, "volume get", options.out);
  const auto result = fetch(context, options);
  if (!result) return result.status();
  const Expected<Array> array = arrayOf(result->volume, options);
  if (!array) return array.status();
  if (Status status = writeFile(options.out, npyFile(array->shape, array->values)); !status.ok()) return status;
  if (context.json()) print(metadata(options, *array, *result));
  return {};
}

std::string largestOf(const VolumeLayer& layer) {
  float largest = 0.0F;
  for (const float c : layer.coefficients) largest = std::max(largest, std::abs(c));
  return shortText(double(largest));
}

Status showVolume(Context& context, const VolumeOptions& options) {
  const auto result = fetch(context, options);
  if (!result) return result.status();
  if (context.json()) {
    print(toJson(result->header));
    return {};
  }
  const Grid& grid = result->volume.grid;
  const std::string cells =
      std::to_string(grid.dims.x) + "x" + std::to_string(grid.dims.y) + "x" + std::to_string(grid.dims.z);
  std::vector<std::vector<std::string>> rows = {{"revision", std::to_string(result->header.result().revision())},
                                                {"grid", cells + " cells of " + shortText(grid.cell) + " m"},
                                                {"stage", v1::VolumeStage_Name(result->header.stage())}};
  for (const VolumeLayer& layer : result->volume.layers) {
    rows.push_back({"layer " + std::to_string(rows.size() - 3), "group \"" + layer.group + "\"",
                    "coefficients up to " + largestOf(layer)});
  }
  printTable(rows);
  return {};
}

void addStage(CLI::App& app, VolumeOptions& options) {
  addChoice<v1::VolumeStage>(app, "--stage", options.stage,
                             {{"injected", v1::VOLUME_STAGE_INJECTED}, {"transported", v1::VOLUME_STAGE_TRANSPORTED}},
                             "Light before or after transport (default: transported)");
}

void addGet(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<VolumeOptions>();
  CLI::App& get = commands.add(group, "get", "Save the volume as NumPy float32 (nz,ny,nx,3,4), summed over layers",
                               [given](Context& context) { return getVolume(context, *given); });
  addSession(get, given->id);
  get.add_option("-o,--output", given->out, "File to write; - is stdout")->required()->type_name("OUT.npy");
  addStage(get, *given);
  auto* one = get.add_option("--layer", given->layer, "Save one layer instead of the sum")->type_name("K");
  get.add_flag("--layers", given->layers, "Save all layers: (g,nz,ny,nx,3,4)")->excludes(one);
  get.add_flag("--guard", given->guard, "Save one cell more on each side, for lookups on the grid's bounds");
}

void addInfo(CLI::App& group, Commands& commands) {
  auto given = std::make_shared<VolumeOptions>();
  CLI::App& info = commands.add(group, "info", "Print the volume's grid and layers, one per light group",
                                [given](Context& context) { return showVolume(context, *given); });
  addSession(info, given->id);
  addStage(info, *given);
}

}  // namespace

void addVolumeCommands(CLI::App& app, Commands& commands) {
  CLI::App& group = Commands::group(app, "volume", "Volumes: get, info");
  addGet(group, commands);
  addInfo(group, commands);
}

}  // namespace lpv::cli
