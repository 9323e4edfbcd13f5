#include "session/delivery/frame_adapter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lpv {
namespace {

/// A level: edges and quality as shares of what is wanted, and the bytes that frames then have, roughly (measured on a
/// lit room: bytes go by pixels, and halve from quality 85 to 60).
struct Level {
  double edge;
  double quality;
  double bytes;
};
constexpr std::array<Level, 8> kLevels = {{{1.0, 1.0, 1.0},
                                           {1.0, 0.8, 0.65},
                                           {1.0, 0.6, 0.5},
                                           {0.75, 0.6, 0.3},
                                           {0.5, 0.6, 0.15},
                                           {0.5, 0.4, 0.11},
                                           {0.35, 0.4, 0.06},
                                           {0.25, 0.4, 0.03}}};

constexpr double kLate = 1.15;       // of the interval: later is too late
constexpr double kInTime = 0.8;      // of the interval: what a finer level has to be expected to keep
constexpr double kSooner = 0.85;     // of the time before: what coarser frames have to gain
constexpr double kSmoothing = 0.4;   // weight of a new measurement
constexpr int kEnough = 3;           // measurements before anything is decided
constexpr int kBeforeFiner = 10;     // the same before going finer
constexpr int kLeaveIt = 100;        // frames
constexpr int kLeastEdge = 16;

int scaledEdge(int edge, double share) {
  if (share == 1.0) return edge;
  const int scaled = int(std::lround(edge * share / 2.0)) * 2;
  return std::clamp(scaled, std::min(edge, kLeastEdge), edge);
}

}  // namespace

int FrameAdapter::coarsest() { return int(kLevels.size()) - 1; }

void FrameAdapter::goTo(int level) {
  level_ = level;
  mean_ = 0.0;
  seen_ = 0;
}

void FrameAdapter::acknowledged(double seconds) {
  // The first at a level may have been on its way, or under way, at the level before.
  if (++seen_ <= 1) return;
  mean_ = mean_ == 0.0 ? seconds : mean_ + kSmoothing * (seconds - mean_);
  stay_ = std::max(0, stay_ - 1);
  if (seen_ <= kEnough) return;
  if (before_ > 0.0) {
    const bool sooner = mean_ <= kSooner * before_;
    before_ = 0.0;
    if (!sooner) {
      stay_ = kLeaveIt;
      return goTo(finer_);
    }
  }
  if (mean_ > kLate * interval_ && level_ < coarsest() && stay_ == 0) {
    // As far as the bytes say, one level at least.
    int next = level_ + 1;
    while (next < coarsest() &&
           mean_ * kLevels[std::size_t(next)].bytes / kLevels[std::size_t(level_)].bytes > interval_)
      ++next;
    before_ = mean_;
    finer_ = level_;
    return goTo(next);
  }
  if (level_ == 0 || seen_ <= kBeforeFiner) return;
  const double finer = mean_ * kLevels[std::size_t(level_ - 1)].bytes / kLevels[std::size_t(level_)].bytes;
  if (finer < kInTime * interval_) goTo(level_ - 1);
}

FrameShape FrameAdapter::shapeFor(const FrameShape& wanted) const {
  const Level& level = kLevels[std::size_t(level_)];
  return {{scaledEdge(wanted.size.x, level.edge), scaledEdge(wanted.size.y, level.edge)},
          std::max(1, int(std::lround(wanted.quality * level.quality)))};
}

}  // namespace lpv
