#include "lpv/device/open_device.h"

#include <string>
#include <vector>

namespace lpv {

namespace {

bool wanted(const gpu::Device& device, const DeviceChoice& choice) {
  switch (choice.kind) {
    case DeviceChoice::Kind::kIndex:
      return device.index == choice.index;
    case DeviceChoice::Kind::kSoftware:
      return device.software || device.platform == "surfaceless";
    case DeviceChoice::Kind::kAuto:
      break;
  }
  return true;
}

/// Surfaceless may be hardware or software: only its context tells.
Expected<gpu::Context> openWanted(const gpu::Device& device, const DeviceChoice& choice) {
  Expected<gpu::Context> context = gpu::Context::make(device);
  if (context.ok() && choice.kind == DeviceChoice::Kind::kSoftware && !context->device().software)
    return Status(Code::kUnavailable, "not a software device");
  return context;
}

std::string describe(const gpu::Device& device) {
  return "device " + std::to_string(device.index) + " (" + device.platform + ", " + device.name + ")";
}

}  // namespace

Expected<gpu::Context> openFirst(const DeviceChoice& choice) {
  std::string reasons;
  for (const gpu::Device& device : gpu::preferredOrder(gpu::listDevices())) {
    if (!wanted(device, choice)) continue;
    Expected<gpu::Context> context = openWanted(device, choice);
    if (context.ok()) return context;
    reasons += (reasons.empty() ? "" : "; ") + describe(device) + ": " + context.status().message();
  }
  if (reasons.empty()) reasons = "no device " + std::to_string(choice.index) + "; see --list-devices";
  return Status(Code::kUnavailable, "no OpenGL 4.5 context: " + reasons);
}

Expected<DeviceChoice> parseDeviceChoice(const std::string& text) {
  if (text == "auto") return DeviceChoice{};
  if (text == "software") return DeviceChoice{DeviceChoice::Kind::kSoftware, 0};
  const bool digits = !text.empty() && text.size() < 4 && text.find_first_not_of("0123456789") == std::string::npos;
  if (digits) return DeviceChoice{DeviceChoice::Kind::kIndex, std::stoi(text)};
  return invalid("device", "device is \"" + text + "\"; want auto, software or an index of --list-devices");
}

std::vector<std::string> describeDevices(const DeviceChoice& choice) {
  std::vector<gpu::Device> devices = gpu::listDevices();
  std::vector<std::string> lines(devices.size());
  bool chosen = false;
  for (const gpu::Device& device : gpu::preferredOrder(devices)) {
    std::string& line = lines[std::size_t(device.index)];
    line = describe(device) + ": ";
    const Expected<gpu::Context> context = openWanted(device, choice);
    if (!context.ok()) {
      line += "not usable: " + context.status().message();
      continue;
    }
    line += context->capabilities().renderer + ", OpenGL " + context->capabilities().version;
    line += context->device().software ? ", software" : ", hardware";
    const bool used = !chosen && wanted(device, choice);
    chosen = chosen || used;
    line += used                     ? ": would be used"
            : wanted(device, choice) ? ": works, comes after another"
                                     : ": works, not asked for";
  }
  return lines;
}

}  // namespace lpv
