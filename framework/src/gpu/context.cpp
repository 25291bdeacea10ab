// EGL without a display: the device platform where there is a hardware device, the surfaceless platform
// otherwise.
#include <dlfcn.h>
#include <epoxy/egl.h>
#include <fmt/format.h>

#include <charconv>

#include "gpu/state.h"
#include "lumivox/base/error.h"

namespace lumivox::gpu {
namespace {

/// The context that is current on this thread; null if none is.
thread_local const Context* currentContext = nullptr;

std::string eglErrorName() {
  switch (eglGetError()) {
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH (no OpenGL 4.5 core profile)";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    default:
      return "no further reason given";
  }
}

/// Why the dynamic loader cannot open the library, or empty. An opened library stays open, as with epoxy.
std::string whyNotOpened(const char* library) {
  if (dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr) return {};
  const char* reason = dlerror();
  return reason != nullptr ? reason : "the dynamic loader refused it";
}

/// epoxy ends the process when it cannot open these libraries; ask first.
void requireLibraries() {
  if (const std::string why = whyNotOpened("libEGL.so.1"); !why.empty())
    throw AbsentError("no OpenGL: libEGL.so.1 (Debian package libegl1) cannot be opened: " + why);
  // epoxy loads the functions of OpenGL from either library.
  if (const std::string why = whyNotOpened("libOpenGL.so.0");
      !why.empty() && !whyNotOpened("libGL.so.1").empty())
    throw AbsentError(
        "no OpenGL: neither libOpenGL.so.0 (Debian package libopengl0) nor libGL.so.1 (libgl1) can be opened: " +
        why);
}

bool hasWord(const char* words, std::string_view word) {
  if (words == nullptr) return false;
  const std::string_view text = words;
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || text[at - 1] == ' ') && (end == text.size() || text[end] == ' ')) return true;
  }
  return false;
}

struct EglDevice {
  EGLDeviceEXT handle;
  bool software;
};

std::vector<EglDevice> eglDevices() {
  std::vector<EglDevice> devices;
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
      !(epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))) {
    return devices;
  }
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count <= 0) return devices;
  std::vector<EGLDeviceEXT> handles(static_cast<std::size_t>(count));
  if (!eglQueryDevicesEXT(count, handles.data(), &count)) return devices;
  // The extension that describes a device may be missing. Then the renderer's name tells, once there is a
  // context.
  const bool tells = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_query") ||
                     epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base");
  for (EGLint i = 0; i < count; ++i) {
    const EGLDeviceEXT handle = handles[static_cast<std::size_t>(i)];
    devices.push_back({handle, tells && hasWord(eglQueryDeviceStringEXT(handle, EGL_EXTENSIONS),
                                                "EGL_MESA_device_software")});
  }
  return devices;
}

/// Requests robustness (EGL 1.5) if the driver has it: the context reports resets. In a debug context,
/// accesses beyond a resource are defined too; they cost time, so other contexts go without.
EGLContext createContext(EGLDisplay display, EGLConfig config, bool debug) {
  std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_CONTEXT_OPENGL_DEBUG,
                                 debug ? EGL_TRUE : EGL_FALSE,
                                 EGL_NONE};
  const std::vector<EGLint> plain = attributes;
  attributes.pop_back();
  attributes.insert(attributes.end(),
                    {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET,
                     EGL_CONTEXT_OPENGL_ROBUST_ACCESS, debug ? EGL_TRUE : EGL_FALSE, EGL_NONE});
  const EGLContext robust = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes.data());
  return robust != EGL_NO_CONTEXT ? robust : eglCreateContext(display, config, EGL_NO_CONTEXT, plain.data());
}

EGLDisplay deviceDisplay(const EglDevice& device) {
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device.handle, nullptr);
}

EGLDisplay surfacelessDisplay() {
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) return EGL_NO_DISPLAY;
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
}

}  // namespace

bool isSoftwareRenderer(const std::string& renderer) {
  for (const char* word : {"llvmpipe", "softpipe", "swrast", "SWR", "SwiftShader", "Software Rasterizer"}) {
    if (renderer.find(word) != std::string::npos) return true;
  }
  return false;
}

bool Context::tryDisplay(void* display, const std::string& platform, std::string& failures) {
  const auto fail = [&](const std::string& why) {
    failures += fmt::format("\n  {}: {}", platform, why);
    return false;
  };
  if (display == EGL_NO_DISPLAY) return fail("not offered by EGL");
  // EGL hands out one display per platform and process. It is never terminated: other contexts may use it,
  // and unloading a driver only to load it again for the next context is slow and, in Mesa, leaks.
  if (!eglInitialize(display, nullptr, nullptr)) return fail("eglInitialize failed, " + eglErrorName());
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context")) {
    return fail("lacks EGL_KHR_surfaceless_context");
  }
  if (!eglBindAPI(EGL_OPENGL_API)) return fail("has no OpenGL, only OpenGL ES");
  const EGLint configAttributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT,
                                     EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, configAttributes, &config, 1, &count) || count == 0)
    config = EGL_NO_CONFIG_KHR;
  EGLContext context = createContext(display, config, debug_);
  if (context == EGL_NO_CONTEXT) return fail("no OpenGL 4.5 core context, " + eglErrorName());
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    const std::string why = "eglMakeCurrent failed, " + eglErrorName();
    eglDestroyContext(display, context);
    return fail(why);
  }
  currentContext = this;
  display_ = display;
  context_ = context;
  platform_ = platform;
  return true;
}

Context::Context(const std::string& request, bool debug) : debug_(debug) {
  requireLibraries();
  const std::vector<EglDevice> devices = eglDevices();
  const auto platformOf = [](std::size_t index) { return fmt::format("EGL device {}", index); };
  std::string failures;
  const auto renderer = [] { return std::string(reinterpret_cast<const char*>(glGetString(GL_RENDERER))); };
  const auto dropContext = [&](const std::string& why) {
    failures += fmt::format("\n  {}: {}", platform_, why);
    destroy();
  };

  if (request == "auto" || request == "software") {
    const bool wantSoftware = request == "software";
    for (std::size_t i = 0; i < devices.size(); ++i) {
      // The surfaceless platform is preferred to Mesa's software device: it is the older and better tested
      // path.
      if (wantSoftware || devices[i].software) continue;
      if (!tryDisplay(deviceDisplay(devices[i]), platformOf(i), failures)) continue;
      if (!isSoftwareRenderer(renderer())) return;
      dropContext("draws in software");
    }
    if (tryDisplay(surfacelessDisplay(), "EGL surfaceless", failures)) {
      if (!wantSoftware || isSoftwareRenderer(renderer())) return;
      dropContext("is not a software rasteriser but " + renderer());
    }
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (devices[i].software && tryDisplay(deviceDisplay(devices[i]), platformOf(i), failures)) return;
    }
  } else if (request == "surfaceless") {
    if (tryDisplay(surfacelessDisplay(), "EGL surfaceless", failures)) return;
  } else {
    std::size_t index = 0;
    const auto [end, problem] = std::from_chars(request.data(), request.data() + request.size(), index);
    if (request.empty() || problem != std::errc{} || end != request.data() + request.size()) {
      throw Error(fmt::format(
          "unknown device '{}'; expected auto, software, surfaceless or the index of an EGL device",
          request));
    }
    if (index >= devices.size()) {
      throw AbsentError(fmt::format("there is no EGL device {}; this machine has {} (counted from 0)", index,
                                    devices.size()));
    }
    if (tryDisplay(deviceDisplay(devices[index]), platformOf(index), failures)) return;
  }
  throw AbsentError(fmt::format(
      "no OpenGL 4.5 core context for device '{}':{}", request,
      failures.empty() ? "\n  EGL offers neither a device nor the surfaceless platform" : failures));
}

Context::~Context() {
  destroy();
}

void Context::destroy() {
  if (currentContext == this) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    currentContext = nullptr;
  }
  eglDestroyContext(display_, context_);
  context_ = nullptr;
}

bool Context::tryMakeCurrent() const noexcept {
  if (currentContext == this) return true;
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return false;
  currentContext = this;
  return true;
}

void Context::makeCurrent() const {
  if (!tryMakeCurrent())
    throw Error(fmt::format("{}: cannot make the OpenGL context current, {}", platform_, eglErrorName()));
}

}  // namespace lumivox::gpu
