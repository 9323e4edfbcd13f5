#pragma once
// Lists EGL devices: device platform first, hardware before software, surfaceless as the fallback.

#include <string>
#include <vector>

namespace lpv::gpu {

/// One way to get an EGL display. A small value; a Context made from it opens the display.
struct Device {
  int index = -1;             ///< position in listDevices()
  std::string platform;       ///< "device" or "surfaceless"
  std::string name;           ///< name known before a context exists: DRM node, "software", ...
  bool software = false;      ///< known to rasterise on the CPU
  void* eglDevice = nullptr;  ///< EGLDeviceEXT; null for surfaceless
};

/// Sets LP_NUM_THREADS, unless it is set, to twice the number of cores. Mesa's default is one worker per core, and an
/// idle kernel may wake two of them on one core: on 2 cores a dispatch of some milliseconds then takes as long as on 1,
/// with 4 workers half of that. Changes the environment, so call it first in main, before other threads start.
void askForSoftwareWorkers();

/// All devices in EGL's order, then surfaceless. Never empty.
std::vector<Device> listDevices();

/// All devices in the order in which --device auto tries them: hardware, software, surfaceless.
std::vector<Device> preferredOrder(std::vector<Device> devices);

/// An initialised EGLDisplay for the device, or null with `reason` set. Displays stay open until the process ends: EGL
/// has one per device, shared by the whole process.
void* openDisplay(const Device& device, std::string& reason);

}  // namespace lpv::gpu
