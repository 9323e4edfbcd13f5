#include "gpu/context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "gpu/debug.h"
#include "gpu/gl.h"
#include "gpu/shader_source.h"

namespace lpv::gpu {

namespace {

bool debugWanted() {
  const char* value = std::getenv("LPV_GL_DEBUG");
  return value != nullptr && std::strcmp(value, "1") == 0;
}

bool displayHas(EGLDisplay display, const char* extension) {
  const char* list = eglQueryString(display, EGL_EXTENSIONS);
  return list != nullptr && std::strstr(list, extension) != nullptr;
}

/// A configuration for desktop GL, or none if the driver needs none (EGL_KHR_no_config_context).
EGLConfig chooseConfig(EGLDisplay display) {
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLint count = 0;
  if (eglChooseConfig(display, wanted, &config, 1, &count) != EGL_TRUE || count == 0) return EGL_NO_CONFIG_KHR;
  return config;
}

EGLContext createContext(EGLDisplay display, EGLConfig config, bool robust, bool debug) {
  std::vector<EGLint> attributes = {EGL_CONTEXT_MAJOR_VERSION,       4,
                                    EGL_CONTEXT_MINOR_VERSION,       5,
                                    EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
  if (robust) {
    attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_ROBUST_ACCESS, EGL_TRUE,
                                         EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
  }
  if (debug) attributes.insert(attributes.end(), {EGL_CONTEXT_OPENGL_DEBUG, EGL_TRUE});
  attributes.push_back(EGL_NONE);
  return eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
}

Status unavailable(const std::string& message) { return {Code::kUnavailable, message}; }

}  // namespace

Expected<Context> Context::make(const Device& device, bool debug) {
  std::string reason;
  const EGLDisplay display = openDisplay(device, reason);
  if (display == nullptr) return unavailable(reason);
  if (!displayHas(display, "EGL_KHR_surfaceless_context")) return unavailable("the driver has no surfaceless contexts");
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return unavailable("the driver has no desktop OpenGL, only OpenGL ES");
  debug = debug || debugWanted();
  const EGLConfig config = chooseConfig(display);
  EGLContext context = createContext(display, config, true, debug);
  if (context == EGL_NO_CONTEXT) context = createContext(display, config, false, debug);
  if (context == EGL_NO_CONTEXT) return unavailable("the driver has no OpenGL 4.5 core context");
  if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE) {
    eglDestroyContext(display, context);
    return unavailable("its context cannot be made current without a surface");
  }
  return Context(device, display, context, debug);
}

Context::Context(Device device, void* display, void* context, bool debug)
    : device_(std::move(device)), display_(display), context_(context), capabilities_(probeCapabilities()) {
  device_.software = device_.software || capabilities_.software;
  defineForDevice({{"LPV_EXACT_FILTER", capabilities_.exactFilter ? "1" : "0"}});
  installDebugOutput(debug);
}

Context::Context(Context&& other) noexcept
    : device_(std::move(other.device_)),
      display_(std::exchange(other.display_, nullptr)),
      context_(std::exchange(other.context_, nullptr)),
      capabilities_(std::move(other.capabilities_)) {}

Context& Context::operator=(Context&& other) noexcept {
  Context taken(std::move(other));
  std::swap(device_, taken.device_);
  std::swap(display_, taken.display_);
  std::swap(context_, taken.context_);
  std::swap(capabilities_, taken.capabilities_);
  return *this;
}

Context::~Context() { abandon(); }

void Context::abandon() {
  if (context_ == nullptr) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  context_ = nullptr;
}

bool Context::lost() const {
  if (context_ == nullptr) return true;
  if (eglGetCurrentContext() != context_ &&
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
    return true;
  return glGetGraphicsResetStatus() != GL_NO_ERROR;
}

void Context::makeCurrent() const { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_); }

}  // namespace lpv::gpu
