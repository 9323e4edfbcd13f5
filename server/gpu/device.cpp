#include "gpu/device.h"

#define EGL_EGLEXT_PROTOTYPES 0
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <thread>

#include "base/mutex.h"

namespace lpv::gpu {

namespace {

constexpr int kMaxDevices = 32;
constexpr unsigned kMostSoftwareWorkers = 16;  ///< Mesa's limit
#ifndef EGL_PLATFORM_SURFACELESS_MESA
constexpr EGLenum EGL_PLATFORM_SURFACELESS_MESA = 0x31DD;
#endif

bool contains(const char* list, const char* word) { return list != nullptr && std::strstr(list, word) != nullptr; }

template <typename Function>
Function load(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::string nameOf(EGLDeviceEXT device, const char* extensions, bool software) {
  static const auto query = load<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (contains(extensions, "EGL_EXT_device_query_name")) {
    if (const char* text = query(device, EGL_RENDERER_EXT)) return text;
  }
  if (contains(extensions, "EGL_EXT_device_drm")) {
    if (const char* text = query(device, EGL_DRM_DEVICE_FILE_EXT)) return text;
  }
  return software ? "software" : "unnamed";
}

std::vector<Device> eglDevices() {
  std::vector<Device> found;
  if (!contains(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_EXT_device_enumeration") &&
      !contains(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_EXT_device_base"))
    return found;
  const auto enumerate = load<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query = load<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  std::array<EGLDeviceEXT, kMaxDevices> devices{};
  EGLint count = 0;
  if (enumerate == nullptr || query == nullptr || enumerate(kMaxDevices, devices.data(), &count) != EGL_TRUE)
    return found;
  for (int i = 0; i < count; ++i) {
    const char* extensions = query(devices[std::size_t(i)], EGL_EXTENSIONS);
    const bool software = contains(extensions, "EGL_MESA_device_software");
    found.push_back(
        {i, "device", nameOf(devices[std::size_t(i)], extensions, software), software, devices[std::size_t(i)]});
  }
  return found;
}

EGLDisplay displayOf(const Device& device) {
  const EGLenum platform = device.eglDevice != nullptr ? EGL_PLATFORM_DEVICE_EXT : EGL_PLATFORM_SURFACELESS_MESA;
  void* native = device.eglDevice != nullptr ? device.eglDevice : reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY);
  return eglGetPlatformDisplay(platform, native, nullptr);
}

}  // namespace

void askForSoftwareWorkers() {
  const unsigned workers = std::min(2 * std::max(1U, std::thread::hardware_concurrency()), kMostSoftwareWorkers);
  setenv("LP_NUM_THREADS", std::to_string(workers).c_str(), 0);
}

std::vector<Device> listDevices() {
  std::vector<Device> devices = eglDevices();
  devices.push_back({int(devices.size()), "surfaceless", "Mesa surfaceless", false, nullptr});
  return devices;
}

std::vector<Device> preferredOrder(std::vector<Device> devices) {
  const auto rank = [](const Device& d) { return d.platform == "surfaceless" ? 2 : d.software ? 1 : 0; };
  std::stable_sort(devices.begin(), devices.end(), [&](const Device& a, const Device& b) { return rank(a) < rank(b); });
  return devices;
}

void* openDisplay(const Device& device, std::string& reason) {
  static Mutex mutex;
  static std::map<void*, EGLDisplay> open LPV_GUARDED_BY(mutex);
  const MutexLock lock(mutex);
  if (const auto found = open.find(device.eglDevice); found != open.end()) return found->second;
  const EGLDisplay display = displayOf(device);
  if (display == EGL_NO_DISPLAY) {
    reason = "EGL has no display for this device";
    return nullptr;
  }
  if (eglInitialize(display, nullptr, nullptr) != EGL_TRUE) {
    reason = "its EGL display cannot be initialised";
    return nullptr;
  }
  open.emplace(device.eglDevice, display);
  return display;
}

}  // namespace lpv::gpu
