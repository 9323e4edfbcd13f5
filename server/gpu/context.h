#pragma once

#include <memory>
#include <string>

#include "base/status.h"
#include "gpu/capabilities.h"
#include "gpu/device.h"

namespace lpv::gpu {

/// An OpenGL 4.5 core context without a window: robust with lose-on-reset where the driver can, a debug context when
/// asked for or with LPV_GL_DEBUG=1 in the environment. Current on the thread that made it; that thread owns it and
/// must destroy it. Move-only.
class Context {
 public:
  /// Creates a context on `device` and makes it current. UNAVAILABLE with the reason if that fails.
  static Expected<Context> make(const Device& device, bool debug = false);

  Context(Context&& other) noexcept;
  Context& operator=(Context&& other) noexcept;
  ~Context();

  /// Makes it current again after another context was.
  void makeCurrent() const;

  /// True if the context and all its objects are lost: the driver has reset it (KHR_robustness), or it cannot be made
  /// current (EGL_CONTEXT_LOST). On the thread that owns it.
  bool lost() const;
  /// Destroys the context without telling the objects created in it, like a reset by the driver. For tests.
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
