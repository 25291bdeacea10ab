// What a driver can do that this machine's drivers do not: the tests put functions of their own in the place
// of the driver's, where the loader of OpenGL keeps their addresses.
#include <dlfcn.h>
#include <epoxy/egl.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <utility>

#include "gpu/state.h"
#include "lumivox/base/error.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::gpu;
using lumivox::test::Tells;

namespace {

/// `name`'s address is `function`'s while this lives.
template <class Function>
class InPlaceOf {
 public:
  InPlaceOf(const char* name, Function function) : place_(static_cast<Function*>(dlsym(RTLD_DEFAULT, name))) {
    REQUIRE(place_ != nullptr);
    before_ = *place_;
    *place_ = function;
  }
  ~InPlaceOf() { *place_ = before_; }
  InPlaceOf(const InPlaceOf&) = delete;
  InPlaceOf& operator=(const InPlaceOf&) = delete;
  Function before() const { return before_; }

 private:
  Function* place_;
  Function before_;
};
using ErrorFunction = GLenum (*)();

GLenum lostError() {
  return GL_CONTEXT_LOST;
}
template <GLenum Status>
GLenum resetStatus() {
  return Status;
}

/// The message of a frame's end on a device that was reset in pass "gather".
std::string messageAfter(ErrorFunction error, ErrorFunction status) {
  Device device({"auto"});
  device.enterPass("gather");
  const InPlaceOf<ErrorFunction> errors("epoxy_glGetError", error);
  const InPlaceOf<ErrorFunction> resets("epoxy_glGetGraphicsResetStatus", status);
  return test::messageOf<Error>([&] { device.finish(); });
}

}  // namespace

TEST_CASE("a lost context is an error that says who was the cause and where") {
  CHECK(
      messageAfter(lostError, resetStatus<GL_GUILTY_CONTEXT_RESET>) ==
      "running the device's commands: the OpenGL context is lost with all that it held "
      "(GL_GUILTY_CONTEXT_RESET: the device was reset while it ran commands of this process, which took too "
      "long or reached beyond a resource; pass gather was under way, but an earlier command may be the "
      "cause); run it again");
  CHECK_THAT(messageAfter(lostError, resetStatus<GL_INNOCENT_CONTEXT_RESET>),
             Tells("commands of another process"));
  CHECK_THAT(messageAfter(lostError, resetStatus<GL_UNKNOWN_CONTEXT_RESET>), Tells("does not know why"));
  // The reset is over, the context stays lost.
  CHECK_THAT(messageAfter(lostError, resetStatus<GL_NO_ERROR>), Tells("does not know why"));
}

TEST_CASE("a context that tells of resets is asked, and stays lost once it said so") {
  Device device({"auto"});
  device.finish();
  DeviceState& state = *device.state();
  state.tellsResets = true;
  {
    const InPlaceOf<ErrorFunction> resets("epoxy_glGetGraphicsResetStatus",
                                          resetStatus<GL_INNOCENT_CONTEXT_RESET>);
    CHECK_THROWS_MATCHES(device.finish(), Error, Tells("commands of another process"));
  }
  CHECK_THROWS_MATCHES(Buffer(device, 16, "next"), Error, Tells("next", "commands of another process"));
}

namespace {

int texturesReleased = 0;
void countReleased(GLsizei count, const GLuint*) {
  texturesReleased += count;
}

}  // namespace

TEST_CASE("what a lost context held is gone with it: nothing is released through it") {
  const TextureDescription description{TextureKind::d2, Format::r32f, 4, 4, 1, 1};
  Device device({"auto"});
  { const Texture first(device, description, "first"); }  // which makes the loader know the function
  const InPlaceOf<void (*)(GLsizei, const GLuint*)> release("epoxy_glDeleteTextures", countReleased);
  texturesReleased = 0;
  { const Texture kept(device, description, "of a context that is there"); }
  CHECK(texturesReleased == 1);
  {
    const Texture gone(device, description, "of a context that is lost");
    CHECK(device.state()->allocatedBytes == 64);
    device.state()->lost = Reset::own;
  }
  CHECK(texturesReleased == 1);
  CHECK(device.state()->allocatedBytes == 0);
}

namespace {

std::vector<EGLint> asked;
bool robustAllowed = true;
using CreateFunction = EGLContext (*)(EGLDisplay, EGLConfig, EGLContext, const EGLint*);
CreateFunction createContextThere = nullptr;

EGLint valueOf(EGLint name) {
  for (std::size_t i = 0; i + 1 < asked.size(); i += 2)
    if (asked[i] == name) return asked[i + 1];
  return -1;
}

EGLContext createContextHere(EGLDisplay display, EGLConfig config, EGLContext share,
                             const EGLint* attributes) {
  asked.clear();
  for (const EGLint* at = attributes; *at != EGL_NONE; at += 2) asked.insert(asked.end(), {at[0], at[1]});
  if (!robustAllowed && valueOf(EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY) != -1) return EGL_NO_CONTEXT;
  // Whether this driver can is another matter.
  constexpr EGLint kPlain[] = {EGL_CONTEXT_MAJOR_VERSION,
                               4,
                               EGL_CONTEXT_MINOR_VERSION,
                               5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               EGL_NONE};
  return createContextThere(display, config, share, kPlain);
}

}  // namespace

TEST_CASE("a context is asked to tell of resets, and made without where the driver cannot") {
  const Device first({"auto"});  // which makes the loader know the function
  robustAllowed = true;
  InPlaceOf<CreateFunction> create("epoxy_eglCreateContext", createContextHere);
  createContextThere = create.before();
  {
    const Device device({"auto"});
    CHECK(valueOf(EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY) == EGL_LOSE_CONTEXT_ON_RESET);
    CHECK(valueOf(EGL_CONTEXT_OPENGL_ROBUST_ACCESS) == (DeviceOptions{}.debugContext ? EGL_TRUE : EGL_FALSE));
  }
  robustAllowed = false;
  CHECK_NOTHROW(Device({"auto"}));
  CHECK(valueOf(EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY) == -1);
}

namespace {

using GlTextFunction = const GLubyte* (*)(GLenum);
GlTextFunction glTextThere = nullptr;
const GLubyte* textOfHardware(GLenum name) {
  return name == GL_RENDERER ? reinterpret_cast<const GLubyte*>("a graphics card") : glTextThere(name);
}
bool oneMore = true;
EGLContext createOneMore(EGLDisplay display, EGLConfig config, EGLContext share, const EGLint* attributes) {
  return std::exchange(oneMore, false) ? createContextThere(display, config, share, attributes)
                                       : EGL_NO_CONTEXT;
}

}  // namespace

TEST_CASE("a device goes on where another could not be made beside it") {
  Device device({"auto"});
  Texture texture(device, {TextureKind::d2, Format::r32f, 2, 2, 1, 1}, "small");
  {
    const InPlaceOf<GlTextFunction> text("epoxy_glGetString", textOfHardware);
    glTextThere = text.before();
    const InPlaceOf<CreateFunction> create("epoxy_eglCreateContext", createOneMore);
    createContextThere = create.before();
    // Its context becomes current and is dropped, since it does not draw in software.
    CHECK_THROWS_MATCHES(Device({"software"}), Error, Tells("software"));
    CHECK(!oneMore);
  }
  texture.uploadFloats(0, std::vector<float>{1.0f, 2.0f, 3.0f, 4.0f});
  CHECK(texture.downloadFloats(0) == std::vector<float>{1.0f, 2.0f, 3.0f, 4.0f});
}

namespace {

using TextFunction = const char* (*)(EGLDisplay, EGLint);
TextFunction textThere = nullptr;
std::string wordsWithoutQuery;
int deviceTextsAsked = 0;

const char* textWithoutQuery(EGLDisplay display, EGLint name) {
  const char* text = textThere(display, name);
  if (display != EGL_NO_DISPLAY || name != EGL_EXTENSIONS || text == nullptr) return text;
  wordsWithoutQuery = text;
  for (const std::string word : {"EGL_EXT_device_query", "EGL_EXT_device_base"})
    for (std::size_t at = wordsWithoutQuery.find(word); at != std::string::npos;
         at = wordsWithoutQuery.find(word))
      wordsWithoutQuery.erase(at, word.size());
  if (wordsWithoutQuery.find("EGL_EXT_device_enumeration") == std::string::npos)
    wordsWithoutQuery += " EGL_EXT_device_enumeration";
  return wordsWithoutQuery.c_str();
}

const char* deviceText(EGLDeviceEXT, EGLint) {
  ++deviceTextsAsked;
  return nullptr;
}

}  // namespace

TEST_CASE("a device is not asked what it is where EGL does not offer that question") {
  const Device first({"auto"});
  InPlaceOf<TextFunction> text("epoxy_eglQueryString", textWithoutQuery);
  textThere = text.before();
  const InPlaceOf<const char* (*)(EGLDeviceEXT, EGLint)> deviceTexts("epoxy_eglQueryDeviceStringEXT",
                                                                     deviceText);
  deviceTextsAsked = 0;
  CHECK_NOTHROW(Device({"auto"}));
  CHECK(deviceTextsAsked == 0);
}

namespace {

std::vector<GLuint64> stamps;  // those that are read next, the first one last
using QueryFunction = void (*)(GLuint, GLenum, GLuint64*);

void nextStamp(GLuint, GLenum, GLuint64* value) {
  *value = stamps.back();
  stamps.pop_back();
}

}  // namespace

TEST_CASE("a pass during which the counter of time stamps begins again at 0 has its own time") {
  Device device({"auto"});
  DeviceState& state = *device.state();
  CHECK(state.limits.timestampBits >= 30);
  state.limits.timestampBits = 36;
  state.timersChecked = state.info.timerQueriesTrusted = true;
  const InPlaceOf<QueryFunction> query("epoxy_glGetQueryObjectui64v", nextStamp);
  constexpr GLuint64 kFull = GLuint64{1} << 36;
  stamps = {500'000, kFull - 1'000'000};
  CHECK(device.time([] {}).deviceMs == Approx(1.5));
  PassTimers timers(device, 2);
  timers.beginFrame();
  timers.begin();
  timers.end();
  timers.endFrame();
  stamps = {500'000, kFull - 1'000'000};
  const auto frames = timers.takeAll();
  REQUIRE(frames.size() == 1);
  REQUIRE(frames[0].size() == 1);
  CHECK(frames[0][0] == Approx(1.5));
}

namespace {

using DownloadFunction = void (*)(GLuint, GLint, GLint, GLint, GLint, GLsizei, GLsizei, GLsizei, GLenum,
                                  GLenum, GLsizei, void*);
DownloadFunction downloadThere = nullptr;
GLsizei largestPart = 0;

void downloadHere(GLuint texture, GLint level, GLint x, GLint y, GLint z, GLsizei width, GLsizei height,
                  GLsizei depth, GLenum format, GLenum type, GLsizei size, void* texels) {
  largestPart = std::max(largestPart, size);
  downloadThere(texture, level, x, y, z, width, height, depth, format, type, size, texels);
}

}  // namespace

TEST_CASE("a texture that is downloaded in parts is the texture that was uploaded") {
  Device device({"auto"});
  const auto kind = GENERATE(TextureKind::d2, TextureKind::d2Array, TextureKind::d3);
  const TextureDescription description{kind, Format::rgba32f, 13, 11, kind == TextureKind::d2 ? 1 : 5, 2};
  Texture texture(device, description, "large");
  std::vector<float> values(static_cast<std::size_t>(13 * 11 * description.depth * 4));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  texture.uploadFloats(0, values);
  texture.downloadFloats(
      0);  // the first call finds the driver's function and writes it over the one looked up here
  InPlaceOf<DownloadFunction> download("epoxy_glGetTextureSubImage", downloadHere);
  downloadThere = download.before();
  for (const std::uint64_t most :
       {std::uint64_t{208}, std::uint64_t{500}, std::uint64_t{5000}, std::uint64_t{1} << 20}) {
    device.state()->limits.downloadBytes = most;
    largestPart = 0;
    CHECK(texture.downloadFloats(0) == values);
    CHECK(static_cast<std::uint64_t>(largestPart) <= most);
    const std::vector<std::byte> bytes = texture.download(0);
    CHECK(std::memcmp(bytes.data(), values.data(), bytes.size()) == 0);
  }
}

namespace {

using OffsetFunction = void (*)(GLfloat, GLfloat);
OffsetFunction offsetThere = nullptr;
GLfloat unitsHere = 1.0f;  // of the driver's own

void offsetHere(GLfloat slope, GLfloat units) {
  offsetThere(slope, units * unitsHere);
}

/// The depth of a level triangle at one half that is drawn with this bias.
float depthWith(float bias) {
  Device device({"auto", ShaderInput::glsl});
  const std::string vertices =
      "#version 450 core\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : "
      "-1.0, 0.5, 1.0); }";
  const std::string pixels = "#version 450 core\nvoid main() {}";
  const std::vector<StageCode> stages{{Stage::vertex, {}, vertices}, {Stage::fragment, {}, pixels}};
  const Program program(device, "level", stages, {});
  const Texture target(device, {TextureKind::d2, Format::depth32f, 4, 4, 1, 1}, "depth");
  {
    const Drawing drawing =
        device.drawTo({.depth = &target}, {.depthTest = true, .depthWrite = true, .depthBiasConstant = bias});
    device.draw(program, {}, 3);
  }
  return target.downloadFloats(0).front();
}

}  // namespace

TEST_CASE("a constant depth bias is the same on drivers with different units of it") {
  // A step of a 32-bit number between one half and 1.
  constexpr float kStep = 0x1p-24f;
  CHECK(depthWith(1000.0f) == 0.5f + 1000.0f * kStep);
  InPlaceOf<OffsetFunction> offset("epoxy_glPolygonOffset", offsetHere);
  offsetThere = offset.before();
  for (const GLfloat units : {2.0f, 0.5f, 8.0f}) {
    unitsHere = units;
    CHECK(depthWith(1000.0f) == 0.5f + 1000.0f * kStep);
    CHECK(depthWith(-1000.0f) == 0.5f - 1000.0f * kStep);
  }
}
