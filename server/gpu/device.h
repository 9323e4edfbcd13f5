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

/// Mesa's software device has a worker per core, and a kernel that finds all cores idle may wake two of them on one: on
/// 2 cores a dispatch of some milliseconds then takes as long as on 1, with 4 workers half of that. Asks for twice as
/// many, unless LP_NUM_THREADS is set. Changes the environment: first thing in main, before there are other threads.
void askForSoftwareWorkers();

/// All devices in EGL's order, then surfaceless. Never empty.
std::vector<Device> listDevices();

/// The same devices in the order in which they are tried without a wish: hardware, software, surfaceless.
std::vector<Device> preferredOrder(std::vector<Device> devices);

/// An initialised EGLDisplay for the device, or null with `reason` set. Displays stay open for the process's life:
/// EGL gives one per device to everybody in it.
void* openDisplay(const Device& device, std::string& reason);

}  // namespace lpv::gpu
