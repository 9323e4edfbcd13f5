#pragma once
// Which EGL devices there are. Device platform first, hardware before software, surfaceless as the fallback.

#include <string>
#include <vector>

namespace lpv::gpu {

/// One way to an EGL display. A small value; nothing is opened until a Context is made from it.
struct Device {
  int index = -1;             ///< position in listDevices()
  std::string platform;       ///< "device" or "surfaceless"
  std::string name;           ///< what EGL says of it before a context exists: DRM node, "software", ...
  bool software = false;      ///< known to rasterise on the CPU
  void* eglDevice = nullptr;  ///< EGLDeviceEXT; null for surfaceless
};

/// All devices in EGL's order, then surfaceless. Never empty.
std::vector<Device> listDevices();

/// The same devices in the order in which they are tried without a wish: hardware, software, surfaceless.
std::vector<Device> preferredOrder(std::vector<Device> devices);

/// An initialised EGLDisplay for the device, or null with `reason` set. Displays stay open for the process's life:
/// EGL gives one per device to everybody in it.
void* openDisplay(const Device& device, std::string& reason);

}  // namespace lpv::gpu
