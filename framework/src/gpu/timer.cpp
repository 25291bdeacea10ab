// Measures device times, and whether this driver's timer queries can be trusted.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <utility>

#include "gpu/counters.h"
#include "gpu/state.h"

namespace lumivox::gpu {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Time between two time stamps, ms; waits for both.
double elapsedMs(GLuint first, GLuint second, GLint timestampBits) {
  GLuint64 begin = 0, end = 0;
  glGetQueryObjectui64v(first, GL_QUERY_RESULT, &begin);
  glGetQueryObjectui64v(second, GL_QUERY_RESULT, &end);
  return static_cast<double>(countedBetween(begin, end, timestampBits)) * 1e-6;
}

// Work that no compiler can shorten: repeated steps of the xorshift generator (Marsaglia 2003, "Xorshift
// RNGs").
constexpr const char* kBusyFunction = R"(#version 450 core
layout(location = 0) uniform uint rounds;
uint busy(uint state) {
  for (uint i = 0u; i < rounds; ++i) {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
  }
  return state;
}
)";
constexpr const char* kBusyCompute = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Words { uint words[]; };
void main() { words[gl_GlobalInvocationID.x] = busy(gl_GlobalInvocationID.x + 1u); }
)";
constexpr const char* kWholeTarget = R"(#version 450 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.5, 1.0); }
)";
constexpr const char* kBusyFragment = R"(
layout(location = 0) out uint word;
void main() { word = busy(uint(gl_FragCoord.y) * 128u + uint(gl_FragCoord.x) + 1u); }
)";

constexpr GLsizei kTargetSize =
    128;  // pixels along a side, hence as many invocations as kGroups work groups of 64
constexpr GLuint kGroups = kTargetSize * kTargetSize / 64;
constexpr double kLeastMs = 5.0;  // far above the clock's resolution and the cost of waiting for the device
constexpr double kTolerance = 0.25;  // largest relative difference of the two clocks
constexpr GLuint kMostRounds = 1u << 26;

/// The same arithmetic in work groups and in pixels: a tiled software rasteriser may have correct time stamps
/// for one of them only.
class BusyWork {
 public:
  enum class Kind { compute, drawing };
  BusyWork()
      : compute_(linkProgram({{GL_COMPUTE_SHADER, {kBusyFunction, kBusyCompute}}})),
        drawing_(linkProgram(
            {{GL_VERTEX_SHADER, {kWholeTarget}}, {GL_FRAGMENT_SHADER, {kBusyFunction, kBusyFragment}}})) {
    glCreateBuffers(1, &words_);
    glNamedBufferStorage(words_, GLsizeiptr{kTargetSize} * kTargetSize * 4, nullptr, 0);
    glCreateTextures(GL_TEXTURE_2D, 1, &target_);
    glTextureStorage2D(target_, 1, GL_R32UI, kTargetSize, kTargetSize);
    glCreateFramebuffers(1, &framebuffer_);
    glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, target_, 0);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, words_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, kTargetSize, kTargetSize);
    glDisable(GL_DEPTH_TEST);
  }
  ~BusyWork() {
    glUseProgram(0);
    glDeleteProgram(compute_);
    glDeleteProgram(drawing_);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteTextures(1, &target_);
    glDeleteBuffers(1, &words_);
  }
  BusyWork(const BusyWork&) = delete;
  BusyWork& operator=(const BusyWork&) = delete;

  void run(Kind kind, GLuint rounds) const {
    glUseProgram(kind == Kind::compute ? compute_ : drawing_);
    glUniform1ui(0, rounds);
    if (kind == Kind::compute) {
      glDispatchCompute(kGroups, 1, 1);
    } else {
      glDrawArrays(GL_TRIANGLES, 0, 3);
    }
  }

 private:
  GLuint compute_, drawing_;
  GLuint words_ = 0, target_ = 0, framebuffer_ = 0;
};

struct Comparison {
  double fencedMs, queriedMs;
};

Comparison measure(const std::array<GLuint, 2>& queries, GLint timestampBits, const BusyWork& work,
                   BusyWork::Kind kind, GLuint rounds) {
  glFinish();
  const auto start = Clock::now();
  glQueryCounter(queries[0], GL_TIMESTAMP);
  work.run(kind, rounds);
  glQueryCounter(queries[1], GL_TIMESTAMP);
  glFinish();
  const double fencedMs = millisecondsSince(start);
  return {fencedMs, elapsedMs(queries[0], queries[1], timestampBits)};
}

/// The comparison with the largest difference of the two clocks, over two amounts of work: a query may be
/// right by chance for one of them.
Comparison worstComparison(const std::array<GLuint, 2>& queries, GLint timestampBits) {
  const BusyWork work;
  Comparison worst{1.0, 1.0};
  const auto difference = [](const Comparison& c) { return std::abs(c.queriedMs - c.fencedMs) / c.fencedMs; };
  for (const auto kind : {BusyWork::Kind::compute, BusyWork::Kind::drawing}) {
    measure(queries, timestampBits, work, kind, 1);  // warm-up
    GLuint rounds = 256;
    while (rounds < kMostRounds && measure(queries, timestampBits, work, kind, rounds).fencedMs < kLeastMs)
      rounds *= 2;
    for (const GLuint amount : {rounds, rounds * 2}) {
      // Takes the better of two, so that an interruption by another process does not discredit the driver.
      const Comparison first = measure(queries, timestampBits, work, kind, amount),
                       second = measure(queries, timestampBits, work, kind, amount);
      const Comparison& better = difference(first) < difference(second) ? first : second;
      if (difference(better) > difference(worst)) worst = better;
    }
  }
  return worst;
}

}  // namespace

void DeviceState::checkTimers() {
  if (timersChecked) return;
  assert(!drawing && "the first look at the device info or times must not be inside of drawing");
  timersChecked = true;
  use();
  info.timerQueriesTrusted = false;
  if (limits.timestampBits == 0) {
    info.timerNote = "fenced clock: the driver has no time stamps";
    return;
  }

  const Comparison worst = worstComparison(timestampQueries, limits.timestampBits);
  const double difference = std::abs(worst.queriedMs - worst.fencedMs) / worst.fencedMs;
  forgetBindings();
  check("checking timer queries");
  info.timerQueriesTrusted = difference <= kTolerance;
  info.timerNote =
      info.timerQueriesTrusted
          ? fmt::format("timer queries: they agree with the fenced clock within {:.0f} %",
                        std::ceil(difference * 100.0))
          : fmt::format("fenced clock: timer queries of this driver said {:.2f} ms for {:.2f} ms of work",
                        worst.queriedMs, worst.fencedMs);
}

Device::Elapsed Device::time(const std::function<void()>& work) {
  DeviceState& state = *state_;
  state.checkTimers();
  state.use();
  if (!state.info.timerQueriesTrusted) {
    glFinish();
    const auto start = Clock::now();
    work();
    const double hostMs = millisecondsSince(start);
    glFinish();
    return {hostMs, millisecondsSince(start)};
  }
  // Own queries, so that timed work may itself time its parts.
  std::array<GLuint, 2> queries{};
  glCreateQueries(GL_TIMESTAMP, 2, queries.data());
  struct Release {
    std::array<GLuint, 2>& queries;
    ~Release() { glDeleteQueries(2, queries.data()); }
  } release{queries};
  const auto start = Clock::now();
  glQueryCounter(queries[0], GL_TIMESTAMP);
  work();
  glQueryCounter(queries[1], GL_TIMESTAMP);
  const double hostMs = millisecondsSince(start);
  return {hostMs, elapsedMs(queries[0], queries[1], state.limits.timestampBits)};
}

// ---- PassTimers
// ---------------------------------------------------------------------------------------------------

struct PassTimers::State {
  std::shared_ptr<DeviceState> device;
  struct Slot {
    std::vector<GLuint> queries;  ///< two for each part, reused in the next frame
    std::size_t parts = 0;
    bool pending = false;  ///< its times are not read back yet
  };
  std::vector<Slot> ring;
  std::size_t next = 0;  ///< slot of the frame under way
  std::vector<Frame> known;

  void read(Slot& slot) {
    if (!std::exchange(slot.pending, false)) return;
    Frame frame;
    for (std::size_t part = 0; part < slot.parts; ++part)
      frame.push_back(
          elapsedMs(slot.queries[2 * part], slot.queries[2 * part + 1], device->limits.timestampBits));
    known.push_back(std::move(frame));
  }
};

PassTimers::PassTimers(Device& device, std::size_t framesUnderWay)
    : state_(new State{device.state(), std::vector<State::Slot>(framesUnderWay), 0, {}}) {
  assert(framesUnderWay > 0);
}

PassTimers::~PassTimers() {
  if (!state_->device->useToRelease()) return;
  for (State::Slot& slot : state_->ring)
    glDeleteQueries(static_cast<GLsizei>(slot.queries.size()), slot.queries.data());
}

void PassTimers::beginFrame() {
  State& s = *state_;
  s.device->use();
  State::Slot& slot = s.ring[s.next];
  s.read(slot);
  slot.parts = 0;
}

void PassTimers::begin() {
  State& s = *state_;
  s.device->use();
  State::Slot& slot = s.ring[s.next];
  if (slot.queries.size() < 2 * (slot.parts + 1)) {
    slot.queries.resize(2 * (slot.parts + 1));
    glCreateQueries(GL_TIMESTAMP, 2, &slot.queries[2 * slot.parts]);
  }
  glQueryCounter(slot.queries[2 * slot.parts], GL_TIMESTAMP);
}

void PassTimers::end() {
  State& s = *state_;
  s.device->use();
  State::Slot& slot = s.ring[s.next];
  glQueryCounter(slot.queries[2 * slot.parts + 1], GL_TIMESTAMP);
  ++slot.parts;
}

void PassTimers::endFrame() {
  State& s = *state_;
  s.ring[s.next].pending = true;
  s.next = (s.next + 1) % s.ring.size();
}

std::vector<PassTimers::Frame> PassTimers::take() {
  return std::exchange(state_->known, {});
}

std::vector<PassTimers::Frame> PassTimers::takeAll() {
  State& s = *state_;
  s.device->use();
  // Starts with the oldest slot, behind the next one to be written.
  for (std::size_t i = 0; i < s.ring.size(); ++i) s.read(s.ring[(s.next + i) % s.ring.size()]);
  return take();
}

}  // namespace lumivox::gpu
