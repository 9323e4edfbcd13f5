#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/status.h"
#include "lpv/latency.h"

namespace lpv::bench {

/// What to run.
struct Load {
  std::string server;                          ///< empty: an lpvd of its own
  std::string sceneFile;                       ///< empty: a procedural room
  std::string lightFile;                       ///< empty: a procedural sphere
  double lightScale = 1.0;
  int lightTriangles = 720;
  std::vector<double> place{0.0, 0.8, 0.0};    ///< metres
  double radiance = 8.0;
  std::vector<double> camera;                  ///< eye, target; empty: the server's choice
  int grid = 32;
  std::string transport = "gather";            ///< or "propagate", "direct"
  int iterations = 32;                         ///< of propagate
  int width = 640;
  int height = 360;
  double rate = 30.0;                          ///< edits per second
  double warmUpSeconds = 3.0;  ///< of the same load before anything is counted, and until a frame has come
  double seconds = 20.0;
  bool deform = false;
  bool orbit = false;                          ///< the light stands still; the camera that is watched goes round
  bool watchFrames = true;
  bool watchVolume = false;
  std::string visibility = "auto";             ///< or "on", "off"
  std::string bounces = "auto";                ///< or a number
  std::string stillFolder;  ///< empty, or where frame.exr and scene.json are written: what the stream shows of the
 ///< light on its place
};

/// What was seen.
struct Measured {
  std::string device;
  std::string version;
  double seconds = 0.0;
  std::int64_t surfaceTriangles = 0;
  std::int64_t lightTriangles = 0;
  double edits = 0.0;
  double ticks = 0.0;
  double frames = 0.0;
  double frameBytes = 0.0;
  double volumes = 0.0;
  double revisionsBehind = 0.0;  ///< median of (last revision acknowledged - revision shown)
  client::LatencySummary latency;  ///< seconds, edit sent to first frame that contains it
  client::LatencySummary warmUpLatency;  ///< likewise, of the edits before
  std::map<std::string, double> firstFrameSeconds;  ///< stages of the very first frame
  std::vector<double> samples;  ///< seconds, of every edit seen, in order; those of the warm-up first
  std::size_t warmUpSamples = 0;
  std::map<std::string, double> stageSeconds;  ///< medians
};

/// Sets the session up, runs the load, takes everything down again.
Expected<Measured> run(const Load& load);

}  // namespace lpv::bench
