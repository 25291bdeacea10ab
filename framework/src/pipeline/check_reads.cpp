// --check-reads renders every frame a second time from scratch. A difference names the pass that should have
// run again, or that was left out although the scene needs it.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "pipeline/executor_state.h"

namespace lumivox {

namespace {

/// Bytes in which the finest levels of two textures differ; all of them when their shapes do.
std::size_t differingBytes(const gpu::Texture& a, const gpu::Texture& b) {
  const std::vector<std::byte> left = a.download(), right = b.download();
  if (!(a.description() == b.description()) || left.size() != right.size())
    return std::max(left.size(), right.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < left.size(); ++i) count += left[i] != right[i] ? 1 : 0;
  return count;
}

/// "412 of 4096 bytes", or empty when nothing differs. Coarser levels may be undefined, so they are not
/// compared.
std::string differenceOf(const OutBase& output, const OutBase& scratch) {
  const std::vector<gpu::TextureRef> a = output.textures(), b = scratch.textures();
  if (a.size() != b.size()) return fmt::format("{} textures in place of {}", a.size(), b.size());
  std::size_t different = 0, all = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    different += differingBytes(*a[i], *b[i]);
    all += a[i]->sizeBytes();
  }
  return different == 0 ? std::string() : fmt::format("{} of {} bytes", different, all);
}

/// Compares an image with the same one of a run that leaves nothing out or, if `lean` is null, with its
/// neutral element.
std::string differenceOfImages(const OutBase& whole, const OutBase* lean) {
  if (whole.contributes() == Contributes::nothing || whole.textures().empty()) return {};
  // The fourth channel of a radiance is unused.
  const int channels = channelsOf(whole.contributes());
  const ImageBuffer image = imageOf(*whole.textures().front(), channels);
  const ImageBuffer other = lean != nullptr
                                ? imageOf(*lean->textures().front(), channels)
                                : neutralImage(image.width(), image.height(), whole.contributes());
  if (!image.sameShape(other)) return "its size differs";
  std::size_t different = 0;
  for (std::size_t i = 0; i < image.values().size(); ++i)
    different += image.values()[i] != other.values()[i] ? 1 : 0;
  return different == 0 ? std::string() : fmt::format("{} of {} values", different, image.values().size());
}

/// Compares one frame of a run with the same frame made from scratch, and with the same frame made without
/// leaving anything out.
class Comparison {
 public:
  Comparison(const BoundGraph& graph, const PrunePlan& plan, const std::vector<PassRecord>& records)
      : graph_(graph), plan_(plan) {
    for (const PassRecord& record : records) ran_[record.name] = record.ran;
  }

  /// Finds outputs that are out of date.
  void compareWithScratch(const BoundGraph& scratch) {
    forEachOutput([&](std::size_t pass, const OutBase& output, OutputIndex index) -> std::string {
      const OutBase& anew = scratch.output(index);
      if (!output.hasValue() || !anew.hasValue()) return {};
      const std::string difference = differenceOf(output, anew);
      return difference.empty()
                 ? std::string()
                 : fmt::format("{} differ from a run from scratch; {}", difference, whyStale(pass));
    });
  }

  /// Finds parts that were left out although they make a difference. Precondition: `lean` is up to date.
  void compareWithWhole(const BoundGraph& lean, const BoundGraph& whole) {
    forEachOutput([&](std::size_t pass, const OutBase&, OutputIndex index) -> std::string {
      const OutBase &less = lean.output(index), &everything = whole.output(index);
      const OutputPlan& planned = plan_.output(index);
      if (!everything.hasValue() || !everything.kind().isSameType(portKind<Image>())) return {};
      // An output without a reader may hold anything if its inputs are left out.
      if (!planned.wanted && (planned.lacksNeed || (planned.impossible && isShown(index)))) {
        const std::string difference = differenceOfImages(everything, nullptr);
        return difference.empty()
                   ? std::string()
                   : fmt::format(
                         "{} are not its neutral element, but it was left out ({}): Needs ask for too much",
                         difference, whyLeftOut(index));
      }
      if (!planned.wanted || !less.hasValue()) return {};
      const std::string difference = differenceOfImages(everything, &less);
      return difference.empty()
                 ? std::string()
                 : fmt::format("{} differ from a run that leaves nothing out; {}", difference, whyLess(pass));
    });
  }

  std::vector<std::string> findings;

 private:
  /// `differs` returns the finding about an output, or nothing. A difference downstream of another one
  /// follows from it and is not reported.
  template <class Differs>
  void forEachOutput(const Differs& differs) {
    std::vector<bool> differing(graph_.passes.size(), false);
    for (const int position : graph_.order) {
      const auto pass = static_cast<std::size_t>(position);
      const BoundPass& bound = graph_.passes[pass];
      const bool follows =
          std::any_of(bound.sources.begin(), bound.sources.end(), [&](const OutputIndex source) {
            return source.valid() && differing[static_cast<std::size_t>(source.pass)];
          });
      differing[pass] = follows;
      const auto& outputs = bound.object->outputs();
      for (std::size_t port = 0; port < outputs.size() && !follows; ++port) {
        const std::string text = differs(pass, *outputs[port], OutputIndex{position, static_cast<int>(port)});
        if (text.empty()) continue;
        differing[pass] = true;
        findings.push_back(fmt::format("pass {}, port {}: {}", bound.name, outputs[port]->name(), text));
      }
    }
  }

  std::string whyStale(std::size_t pass) {
    const BoundPass& bound = graph_.passes[pass];
    if (!ran_[bound.name])
      return fmt::format("it was not run again: it reads more than its readsFrom() declares ({})",
                         readsText(readsOf(bound)));
    std::vector<std::string> suspects;
    addStaleSources(pass, suspects);
    if (!suspects.empty()) return fmt::format("it ran, after {}", fmt::join(suspects, ", "));
    return "it ran: it keeps something whose key leaves out what it depends on";
  }

  /// Adds sources that were not run again and have no texture to compare.
  void addStaleSources(std::size_t pass, std::vector<std::string>& suspects) {
    for (const OutputIndex source : graph_.passes[pass].sources) {
      if (!source.valid() || !plan_.output(source).wanted || !graph_.output(source).textures().empty())
        continue;
      const BoundPass& bound = graph_.passes[static_cast<std::size_t>(source.pass)];
      if (ran_[bound.name]) {
        addStaleSources(static_cast<std::size_t>(source.pass), suspects);
      } else {
        suspects.push_back(
            fmt::format("{}, which was not run again though it may read more than its readsFrom() "
                        "says ({})",
                        bound.name, readsText(readsOf(bound))));
      }
    }
  }

  bool isShown(OutputIndex index) const {
    return std::any_of(graph_.outputs.begin(), graph_.outputs.end(),
                       [&](const BoundOutput& output) { return output.source == index; });
  }

  std::string whyLeftOut(OutputIndex index) const {
    const PassPlan& pass = plan_.passes[static_cast<std::size_t>(index.pass)];
    return pass.kept ? plan_.output(index).why : pass.why;
  }

  /// The parts that the pass and its sources leave out.
  std::string whyLess(std::size_t pass) const {
    std::vector<std::string> left;
    std::vector<bool> seen(graph_.passes.size(), false);
    addLeftOut(pass, seen, left);
    if (left.empty()) return "nothing was left out before it: its shader variants differ";
    return fmt::format("Needs or uses() leave out too much: {}", fmt::join(left, ", "));
  }

  void addLeftOut(std::size_t pass, std::vector<bool>& seen, std::vector<std::string>& left) const {
    if (seen[pass]) return;
    seen[pass] = true;
    const BoundPass& bound = graph_.passes[pass];
    for (std::size_t i = 0; i < bound.sources.size(); ++i) {
      const OutputIndex source = bound.sources[i];
      if (!source.valid()) continue;
      if (plan_.output(source).wanted) {
        addLeftOut(static_cast<std::size_t>(source.pass), seen, left);
      } else {
        left.push_back(fmt::format("input '{}' of {} (from {}: {})", bound.object->inputs()[i]->name(),
                                   bound.name, graph_.outputText(source), whyLeftOut(source)));
      }
    }
  }

  const BoundGraph& graph_;
  const PrunePlan& plan_;
  std::map<std::string, bool> ran_;
};

}  // namespace

void PipelineExecutor::State::checkReads(FrameResult& result) {
  State &anew = *scratch->state_, &everything = *whole->state_;
  // With accumulation, a frame depends on the frames before it: it cannot be made from scratch.
  if (options.accumulate)
    anew.complete = false;
  else
    anew.renewPasses();
  scratch->render(*last, *lastFrameIndex, Images::no);
  whole->render(*last, *lastFrameIndex, Images::no);
  Comparison comparison(graph, *plan, result.passes);
  comparison.compareWithScratch(anew.graph);
  comparison.compareWithWhole(anew.graph, everything.graph);
  result.readsFindings = std::move(comparison.findings);
}

}  // namespace lumivox
