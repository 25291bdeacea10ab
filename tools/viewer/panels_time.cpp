// The panel of times: of the frames of the last seconds and of each pass, with the bounds of the passes.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/file.h"
#include "lumivox/results/text.h"
#include "viewer/panel_rows.h"

namespace lumivox::viewer {
namespace {

/// "37 % of the peak, texture sampling"
std::string shareText(const PassWork& work, double deviceMs) {
  if (work.bounds.empty() || !(deviceMs > 0.0)) return "not known";
  const WorkBound& bound = work.bounds.front();
  return fmt::format("{:.3g} % of the peak rate, {}", 100.0 * bound.ms / deviceMs, bound.resource);
}

void addPass(std::vector<Row>& rows, const RenderedSide& side, const PassTimes& pass,
             const std::string& prefix) {
  const auto record = std::find_if(side.times.begin(), side.times.end(),
                                   [&](const PassRecord& one) { return one.name == pass.name; });
  rows.push_back(text(
      prefix + "pass " + pass.name, "  " + pass.name + (pass.onHost ? " (host)" : ""),
      fmt::format("{:.3f} ms [{:.3f}, {:.3f}], host {:.3f} ms, {}", pass.device.median,
                  pass.device.lowerQuartile, pass.device.upperQuartile, pass.host.median,
                  formatBytes(record == side.times.end() ? 0 : record->bytes)),
      fmt::format("median and quartiles of {} frames; runs {}", pass.device.repeats, wordOf(pass.when))));
  const auto work = side.work.passes.find(pass.name);
  if (work == side.work.passes.end()) return;
  rows.push_back(
      text(prefix + "share " + pass.name, "    share",
           pass.onHost ? "of the host" : shareText(work->second, pass.device.median),
           "the least time that its work can take on the resource that bounds it, over its median"));
  for (const auto& [port, bytes] : work->second.bytes)
    rows.push_back(text(prefix + "port " + pass.name + "." + port, "    " + port, formatBytes(bytes),
                        "what the port holds"));
}

/// Bars of the passes, one row each, and the cost of a frame: once, while something moves, and in every
/// frame.
void addPassTimes(std::vector<Row>& rows, const Session& session, std::size_t side,
                  const std::string& prefix) {
  const RenderedSide& rendered = session.rendered()->sides[side];
  const std::vector<PassTimes> times = session.passTimes(side);
  Row bars;
  bars.kind = Row::Kind::bars;
  bars.name = prefix + "passes";
  bars.label = "medians of passes, ms of the device";
  for (const PassTimes& pass : times) bars.marks.push_back({pass.name, pass.device.median, 0.0, {}});
  rows.push_back(std::move(bars));
  Row stacks;
  stacks.kind = Row::Kind::stacks;
  stacks.name = prefix + "frames";
  stacks.label = fmt::format("frames of the last {:.0f} s, ms of the device", Session::kFrameSeconds);
  double column = 0.0;
  for (const TimedFrame& frame : session.timedFrames()) {
    if (side < frame.sides.size())
      for (const PassRecord& pass : frame.sides[side])
        stacks.marks.push_back({pass.name, column, pass.deviceMs, {}});
    column += 1.0;
  }
  rows.push_back(std::move(stacks));
  double host = 0.0, device = 0.0, ofKind[3] = {0.0, 0.0, 0.0};
  for (const PassTimes& pass : times) {
    addPass(rows, rendered, pass, prefix);
    host += pass.host.median;
    device += pass.device.median;
    ofKind[static_cast<std::size_t>(pass.when)] += pass.device.median;
  }
  rows.push_back(text(prefix + "all passes", "all passes", fmt::format("{:.3f} ms", device),
                      "sum of the medians: what a frame takes in which no pass is kept"));
  for (const RunsWhen when : {RunsWhen::once, RunsWhen::somethingMoves, RunsWhen::everyFrame})
    rows.push_back(text(prefix + "cost " + wordOf(when), std::string("cost ") + wordOf(when),
                        fmt::format("{:.3f} ms", ofKind[static_cast<std::size_t>(when)])));
  rows.push_back(text(prefix + "host", "host", fmt::format("{:.3f} ms in passes", host)));
  if (session.state().countsWork && !rendered.work.why.empty())
    rows.push_back(text(prefix + "peak", "peak rates", "not known: " + rendered.work.why));
}

}  // namespace

Panel timePanel(const Session& session) {
  Panel panel{"time", "Time", {}};
  panel.rows.push_back(toggle("times", "time each pass", session.state().timesPasses, "times {}"));
  panel.rows.push_back(toggle("work", "count work and bytes", session.state().countsWork, "work {}",
                              "of each pass, in a frame of its own that takes several times longer"));
  const RenderedResult rendered = session.rendered();
  if (rendered == nullptr) return panel;
  panel.rows.push_back(text("device", "device", rendered->device));
  if (const std::optional<double> first = session.firstPictureSeconds())
    panel.rows.push_back(
        text("first_picture", "first picture", fmt::format("{:.2f} s after the start", *first)));
  for (std::size_t i = 0; i < rendered->sides.size(); ++i) {
    const RenderedSide& side = rendered->sides[i];
    const std::string prefix = i == 0 ? "" : "beside ";
    if (!side.error.empty()) continue;
    panel.rows.push_back(heading(prefix + rendered->wish.sides[i].pipeline->file.stem().string()));
    std::string kept;
    std::size_t keptPasses = 0;
    for (const PassRecord& pass : side.frame.passes)
      if (!pass.ran) ++keptPasses, kept += (kept.empty() ? "" : ", ") + pass.name;
    panel.rows.push_back(
        text(prefix + "frame", "last frame",
             fmt::format("{:.2f} ms{}", side.frame.frameMs,
                         keptPasses == 0 ? std::string(", all passes run")
                         : keptPasses == side.frame.passes.size()
                             ? std::string(", all of it kept")
                             : fmt::format(", {} of {} passes kept", keptPasses, side.frame.passes.size()))));
    addPassTimes(panel.rows, session, i, prefix);
    panel.rows.push_back(text(prefix + "bytes", "bytes on the device", formatBytes(side.bytes)));
    panel.rows.push_back(text(prefix + "kept", "kept from the frame before", kept.empty() ? "nothing" : kept,
                              "passes whose inputs had not changed"));
  }
  return panel;
}

}  // namespace lumivox::viewer
