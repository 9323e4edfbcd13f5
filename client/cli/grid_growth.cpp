#include "grid_growth.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "command.h"
#include "lpv/convert.h"
#include "output.h"

namespace lpv::cli {
namespace {

/// Cells may grow this much before a command says so.
constexpr double kMuch = 4.0;

double longest(const Bounds& bounds) {
  const glm::dvec3 extent = bounds.extent();
  return std::max({extent.x, extent.y, extent.z});
}

std::string metres(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g m", length);
  const bool plain = std::abs(length) < 1e5 && std::abs(length) >= 1000.0;
  return plain ? std::to_string(std::llround(length)) + " m" : text;
}

/// The power of ten that makes `size` no longer than `room`.
double shrinking(double size, double room) { return std::pow(10.0, std::floor(std::log10(room / size))); }

std::string scaleText(const glm::dvec3& scale) {
  if (scale.x == scale.y && scale.y == scale.z) return shortText(scale.x);
  return shortText(scale.x) + "," + shortText(scale.y) + "," + shortText(scale.z);
}

}  // namespace

GridGrowth::GridGrowth(client::Client client, std::string session)
    : client_(std::move(client)), session_(std::move(session)) {}

Expected<GridGrowth> GridGrowth::since(client::Client& client, const std::string& session) {
  GridGrowth out(client, session);
  const Expected<v1::Session> now = client.session(session);
  if (!now) return now.status();
  if (now->light_count() + now->surface_count() > 0) out.before_ = client::fromProto(now->grid());
  return out;
}

bool GridGrowth::isLarge() const {
  if (!before_) return false;
  const Expected<v1::Session> now = client_.session(session_);
  if (!now) return false;
  after_ = client::fromProto(now->grid());
  return after_.cell > kMuch * before_->cell;
}

void GridGrowth::warn(const std::string& what, const Bounds& added, const std::optional<glm::dvec3>& scale) const {
  const std::string grew = "the cells of the grid grew from " + metres(before_->cell) + " to " + metres(after_.cell);
  const std::string undo = "lpvctl undo " + client::sessionId(session_) + " brings the old grid back";
  const double size = added.empty() ? 0.0 : longest(added), room = longest(before_->bounds());
  if (size <= room) {
    return cli::warn(what + " lies far from everything else: " + grew + " to hold it; " + undo);
  }
  const double factor = shrinking(size, room);
  cli::warn(what + " is " + metres(size) + " long: " + grew + " to hold it; if its file is not in metres, " + undo +
            ", and --scale " + scaleText(scale.value_or(glm::dvec3(1.0)) * factor) + " makes it " +
            metres(size * factor));
}

}  // namespace lpv::cli
