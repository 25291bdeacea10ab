// The file of a graph: Graphviz draws it.
#include <fmt/format.h>
#include <unistd.h>

#include <span>

#include "base/child.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/experiment/pipeline_graph.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// s; drawing a committed pipeline takes less than 1 s
constexpr double kPatience = 60.0;

/// Two hyphens would end the comment or make it invalid.
std::string comment(std::string text) {
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at))
    text.replace(at, 2, "- -");
  return "<!--\n" + text + "-->\n";
}

}  // namespace

fs::path dotProgram() {
  return programOnPath("dot", "which draws graphs", "graphviz", "write the graph's text (.dot)");
}

void writeGraph(const fs::path& file, const std::string& text) {
  if (file.extension() != ".svg") return writeFileAtomically(file, text);
  Child dot({dotProgram().string(), "-Tsvg"}, {});
  dot.write(std::as_bytes(std::span(text)));
  dot.closeInput();
  std::string svg;
  for (Child::Answer answer; (answer = dot.receive(kPatience)).state != Child::State::ended;) {
    if (answer.state == Child::State::silent)
      throw Error(fmt::format("{}: dot has drawn nothing for {:.0f} s", file.string(), kPatience));
    svg += answer.line + "\n";
  }
  if (!dot.succeeded()) {
    const std::string words = dot.lastWords();
    throw Error(fmt::format("{}: dot {}{}", file.string(), dot.ending(),
                            words.empty() ? ", without a word" : ": " + words));
  }
  const std::size_t picture = svg.find("<svg");
  if (picture == std::string::npos) throw Error(fmt::format("{}: dot wrote no picture", file.string()));
  writeFileAtomically(file, svg.insert(picture, comment(text)));
}

}  // namespace lumivox
