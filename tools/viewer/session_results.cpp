// Takes the workers' results and keeps them: pictures, references, errors and times.
#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "lumivox/measure/metrics.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

constexpr std::size_t kFramesKept = 64;  // whose times are shown
constexpr std::size_t kMostTimedFrames = 240;

/// Seconds since the process started, including the time before the session.
double secondsOfProcess() {
  std::ifstream file("/proc/self/stat");
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  // The process's name, in parentheses, may contain spaces. Its start time is field 22, in clock ticks since
  // boot (proc(5)).
  std::istringstream words(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string word;
  for (int i = 0; i < 20; ++i) words >> word;
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) -
         std::strtod(word.c_str(), nullptr) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double medianOfTimes(std::vector<double> times) {
  return statisticsOf(std::move(times)).median;
}

std::string valuesText(const Pipeline& pipeline, const ParameterValues& values) {
  std::string text = pipeline.file.stem().string();
  for (const auto& [name, value] : values) text += fmt::format(" {}={}", name, value.text());
  return text;
}

/// A key of everything that affects the time of a frame; equal keys share their times.
std::string keyOf(const Rendered& rendered, std::size_t side) {
  const Side& what = rendered.wish.sides[side];
  return fmt::format("{} {} {} {} {}x{}", what.pipeline->hash.text(), valuesText(*what.pipeline, what.values),
                     rendered.wish.keepEverything, rendered.wish.scene->hash.text(), rendered.wish.width,
                     rendered.wish.height);
}

}  // namespace

void Session::takeResults() {
  if (std::optional<Rendered> rendered = renderer_.take()) {
    rendered_ = std::make_shared<const Rendered>(std::move(*rendered));
    if (std::all_of(rendered_->sides.begin(), rendered_->sides.end(),
                    [](const RenderedSide& side) { return side.error.empty(); }))
      lastGood_ = rendered_;
    noteTimes();
    noteTried();
    wantReference();
    wantJudgement();
    pictureChanged_ = true;
  }
  if (std::optional<ReferenceResult> reference = tracer_.take()) {
    if (referenceWish_ && (*reference)->wish.isSameView(*referenceWish_)) {
      reference_ = *reference;
      wantJudgement();
      pictureChanged_ = true;
    }
  }
  if (const std::optional<ToolResult> kept = tools_.take()) {
    keeping_ = false;
    say(kept->message, kept->failed);
  }
  if (auto judged = judge_.take()) {
    judged_ = std::move(*judged);
    noteTried();
    pictureChanged_ = true;
  }
}

void Session::wantReference() {
  if (!state_.traces || state_.plays) {
    tracer_.stop();
    referenceWish_.reset();
    return;
  }
  const RenderWish& shown = rendered_->wish;
  ReferenceWish wish{shown.scene,   shown.camera, shown.time,
                     shown.width,   shown.height, bounceLayersOf(*rendered_),
                     state_.samples};
  if (referenceWish_ && referenceWish_->isSameView(wish)) return;
  referenceWish_ = wish;
  reference_.reset();
  judged_.reset();
  tracer_.want(std::move(wish));
}

void Session::wantJudgement() {
  if (reference_ == nullptr || !reference_->error.empty() || rendered_ == nullptr) return;
  judge_.want({rendered_, reference_, state_.exposure});
}

void Session::noteTimes() {
  const double now = secondsOfProcess();
  if (!firstPicture_ && lastGood_ == rendered_) firstPicture_ = now;
  if (!rendered_->sides.front().timed) return;
  TimedFrame frame{now, {}};
  for (const RenderedSide& side : rendered_->sides) frame.sides.push_back(side.times);
  timedFrames_.push_back(std::move(frame));
  while (timedFrames_.size() > kMostTimedFrames || timedFrames_.front().seconds < now - kFrameSeconds)
    timedFrames_.pop_front();
}

void Session::noteTried() {
  const bool judges = judged_ != nullptr && judged_->wish.rendered == rendered_;
  for (std::size_t i = 0; i < rendered_->sides.size(); ++i) {
    const RenderedSide& side = rendered_->sides[i];
    if (!side.error.empty()) continue;
    const Side& what = rendered_->wish.sides[i];
    const std::string key = keyOf(*rendered_, i);
    auto known =
        std::find_if(tried_.begin(), tried_.end(), [&](const TriedPoint& one) { return one.key == key; });
    if (known == tried_.end())
      known =
          tried_.insert(tried_.end(), {valuesText(*what.pipeline, what.values), key, what, 0.0, {}, {}, {}});
    // A frame that reused results of earlier frames does not show the cost.
    const bool whole = std::all_of(side.frame.passes.begin(), side.frame.passes.end(),
                                   [](const PassRecord& pass) { return pass.ran; });
    if (rendered_->wish.number != notedFrame_ && whole) known->times.push_back(side.frame.frameMs);
    if (rendered_->wish.number != notedTimes_ && side.timed)
      for (const PassRecord& pass : side.times) {
        std::vector<PassRecord>& last = known->passes[pass.name];
        last.push_back(pass);
        if (last.size() > kFramesKept) last.erase(last.begin());
      }
    if (!known->times.empty()) {
      known->frameMs = medianOfTimes(known->times);
    } else {
      // The sum over the passes, which were timed with nothing reused; 0 if none was timed.
      known->frameMs = 0.0;
      for (const auto& [pass, records] : known->passes) {
        std::vector<double> times;
        for (const PassRecord& record : records) times.push_back(record.deviceMs);
        known->frameMs += medianOfTimes(std::move(times));
      }
    }
    if (judges)
      for (const JudgedOutput& output : judged_->sides[i])
        if (output.output == kWholeImage) known->error = {output.error.flip, output.error.flipUncertainty};
  }
  // A frame arrives twice: first with its images, then with its times.
  notedFrame_ = rendered_->wish.number;
  if (rendered_->sides.front().timed) notedTimes_ = rendered_->wish.number;
}

std::vector<PassTimes> Session::passTimes(std::size_t side) const {
  std::vector<PassTimes> times;
  if (rendered_ == nullptr || side >= rendered_->sides.size()) return times;
  const RenderedSide& shown = rendered_->sides[side];
  const std::string key = keyOf(*rendered_, side);
  const auto tried =
      std::find_if(tried_.begin(), tried_.end(), [&](const TriedPoint& one) { return one.key == key; });
  if (tried == tried_.end()) return times;
  for (const PassRecord& pass : shown.times) {
    PassTimes one;
    one.name = pass.name;
    one.onHost = pass.onHost;
    std::vector<double> device, host;
    if (const auto records = tried->passes.find(pass.name); records != tried->passes.end())
      for (const PassRecord& record : records->second) {
        device.push_back(record.deviceMs);
        host.push_back(record.hostMs);
      }
    one.device = statisticsOf(std::move(device));
    one.host = statisticsOf(std::move(host));
    const auto when = shown.runs.find(pass.name);
    if (when != shown.runs.end()) one.when = when->second;
    times.push_back(std::move(one));
  }
  return times;
}

}  // namespace lumivox::viewer
