#include "lumivox/experiment/pipeline_graph.h"

#include <fmt/format.h>

#include <map>
#include <sstream>

#include "pipeline/graph.h"

namespace lumivox {
namespace {

constexpr const char* kStyle =
    "  graph [bgcolor=white fontname=Helvetica fontsize=12 nodesep=0.3 ranksep=0.45]\n"
    "  node [shape=box style=filled fillcolor=\"#eef3f8\" color=\"#1f6fb2\" fontname=Helvetica fontsize=12]\n"
    "  edge [color=\"#1f6fb2\" fontname=Helvetica fontsize=11 arrowsize=0.7]\n";
constexpr const char* kLeftOut = " style=dashed color=\"#8a8a8a\" fontcolor=\"#666666\"";
/// Longest line of a reason in a box, in characters.
constexpr std::size_t kReasonWidth = 30;

/// A quoted string of Graphviz, which reads HTML entities in it.
std::string dotString(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n')
      result += "\\n";
    else if (c == '&')
      result += "&amp;";
    else
      result += c;
  }
  return result + '"';
}

/// The reason in lines that fit into a box.
std::string broken(const std::string& reason) {
  std::istringstream words(reason);
  std::string text;
  std::size_t width = kReasonWidth;
  for (std::string word; words >> word;) {
    const bool fits = width + 1 + word.size() <= kReasonWidth;
    text += (fits ? " " : "\n") + word;
    width = fits ? width + 1 + word.size() : word.size();
  }
  return text;
}

/// Why passes, and outputs ("gather.glossy") of passes that run, are left out.
struct Reasons {
  explicit Reasons(const Explanation& explanation) {
    for (const LeftOut& one : explanation.leftOut) {
      if (one.level == LeftOut::Level::pass) passes[one.pass] = one.why;
      if (one.level == LeftOut::Level::resource) outputs[one.what] = one.why;
    }
  }
  /// Empty where the pass is not left out.
  std::string ofPass(const std::string& name) const { return find(passes, name); }
  std::string ofOutput(const std::string& name) const { return find(outputs, name); }

 private:
  using Whys = std::map<std::string, std::string>;
  static std::string find(const Whys& whys, const std::string& name) {
    const auto found = whys.find(name);
    return found == whys.end() ? std::string() : found->second;
  }
  Whys passes, outputs;
};

class Drawing {
 public:
  Drawing(const BoundGraph& graph, const Reasons& reasons) : graph_(graph), reasons_(reasons) {}

  std::string text() {
    for (const BoundPass& pass : graph_.passes) box(pass);
    for (const BoundPass& pass : graph_.passes) {
      for (std::size_t i = 0; i < pass.sources.size(); ++i) {
        if (!pass.sources[i].valid()) continue;
        const InBase& input = *pass.object->inputs()[i];
        const bool history = input.presence() == Presence::history;
        arrow(pass.sources[i], "pass " + pass.name, input.name(), history, reasons_.ofPass(pass.name));
      }
    }
    std::string ends;
    for (const BoundOutput& output : graph_.outputs) {
      const std::string id = "output " + output.name;
      const std::string why = reasons_.ofOutput(graph_.outputText(output.source));
      const bool leftOut = !why.empty() || !reasons_.ofPass(passOf(output.source)).empty();
      text_ += fmt::format("  {} [label={} shape=ellipse{}]\n", dotString(id),
                           dotString(output.name + broken(why)), leftOut ? kLeftOut : "");
      arrow(output.source, id, graph_.output(output.source).name(), false, {});
      ends += " " + dotString(id);
    }
    text_ += "  {rank=sink" + ends + "}\n";
    return text_;
  }

 private:
  const std::string& passOf(OutputIndex index) const {
    return graph_.passes[static_cast<std::size_t>(index.pass)].name;
  }

  void box(const BoundPass& pass) {
    const std::string why = reasons_.ofPass(pass.name);
    const std::string label = fmt::format("{}\n{}.{}{}", pass.name, pass.technique, pass.pass, broken(why));
    text_ += fmt::format("  {} [label={}{}]\n", dotString("pass " + pass.name), dotString(label),
                         why.empty() ? "" : kLeftOut);
  }

  /// An arrow may be left out with its source, with the output alone, or with its reader.
  void arrow(OutputIndex source, const std::string& reader, const std::string& input, bool history,
             std::string why) {
    const OutBase& output = graph_.output(source);
    if (why.empty()) why = reasons_.ofPass(passOf(source));
    if (why.empty()) why = reasons_.ofOutput(graph_.outputText(source));
    std::string label = output.name() == input ? input : output.name() + " \u2192 " + input;
    if (history) label += " \n (frame before)";
    text_ += fmt::format("  {} -> {} [label={} tooltip={}{}{}]\n", dotString("pass " + passOf(source)),
                         dotString(reader), dotString(" " + label + " "),
                         dotString(output.kind().name + (why.empty() ? "" : ": " + why)),
                         history ? " constraint=false" : "", why.empty() ? "" : kLeftOut);
  }

  const BoundGraph& graph_;
  const Reasons& reasons_;
  std::string text_;
};

}  // namespace

std::string graphText(const Pipeline& pipeline, TechniqueSource& techniques, const ParameterValues& settings,
                      const Explanation& explanation, const std::string& scene) {
  const BoundGraph graph = bindPipeline(pipeline, techniques, settings);
  const Reasons reasons(explanation);
  return fmt::format("digraph {} {{\n{}  label={}\n{}}}\n", dotString(pipeline.name), kStyle,
                     dotString(fmt::format("{}, on the scene {}", pipeline.name, scene)),
                     Drawing(graph, reasons).text());
}

}  // namespace lumivox
