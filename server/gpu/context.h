#pragma once

#include <memory>
#include <string>

#include "base/status.h"
#include "gpu/capabilities.h"
#include "gpu/device.h"

namespace lpv::gpu {

/// An OpenGL 4.5 core context without a window: robust with lose-on-reset where the driver can, a debug context when
/// asked for or when the environment says LPV_GL_DEBUG=1. Current on the thread that made it; that thread owns it and
/// must destroy it. Move-only.
class Context {
 public:
  /// Makes a context on `device` and makes it current; UNAVAILABLE with the reason when that cannot be.
  static Expected<Context> make(const Device& device, bool debug = false);

  Context(Context&& other) noexcept;
  Context& operator=(Context&& other) noexcept;
  ~Context();

  /// Makes it current on the calling thread again, after another one was.
  void makeCurrent() const;

  /// Whether everything made in it is gone: the driver has reset it (KHR_robustness), or it cannot be made current
  /// (EGL_CONTEXT_LOST). On the thread that owns it.
  bool lost() const;
  /// Destroys it behind the back of everything made in it, as a driver does that resets. For tests.
  void abandon();

  const Device& device() const { return device_; }
  const Capabilities& capabilities() const { return capabilities_; }

 private:
  Context(Device device, void* display, void* context, bool debug);

  Device device_;
  void* display_ = nullptr;
  void* context_ = nullptr;
  Capabilities capabilities_;
};

}  // namespace lpv::gpu
