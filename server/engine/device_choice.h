#pragma once
// Which device an engine runs on: parsing the choice, listing what there is, starting.

#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "engine/device_choice.h"
#include "engine/engine.h"

namespace lpv {

/// "auto" (hardware before software), "software", or an index of listDevices().
struct DeviceChoice {
  enum class Kind { kAuto, kSoftware, kIndex } kind = Kind::kAuto;
  int index = 0;
};
Expected<DeviceChoice> parseDeviceChoice(const std::string& text);

/// One line per EGL device and fallback: what it is, whether it would be used and why. Starts no thread.
std::vector<std::string> describeDevices(const DeviceChoice& choice);

/// Starts the GL thread; UNAVAILABLE with the reasons per device when no OpenGL 4.5 context can be made.
Expected<std::unique_ptr<Engine>> startEngine(const DeviceChoice& choice);

}  // namespace lpv
