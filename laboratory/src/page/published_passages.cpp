// Tables of published values, written from the declarations of parameters.
#include "lumivox/page/published_passages.h"

#include <fmt/format.h>

#include <algorithm>

#include "page/passages.h"

namespace lumivox {
namespace {

struct Line {
  std::string name, published, ours;
  std::vector<std::string> passes;
};

std::string table(const std::vector<Line>& lines) {
  std::string text = "\n\n| parameter | published | ours | passes |\n|---|---|---|---|\n";
  for (const Line& line : lines)
    text += fmt::format("| `{}` | {} | {} | `{}` |\n", line.name, line.published, line.ours,
                        fmt::join(line.passes, "`, `"));
  return text + "\n";
}

std::string passage(const page::PassageRequest& request, const std::vector<PublishedParameter>& parameters) {
  if (request.kind != "table") page::refuse("kind of passage", request.kind, {"table"});
  const auto technique = [](const PublishedParameter& one) { return one.technique; };
  page::found(parameters, "technique with published values", request.id, technique);
  std::vector<PublishedParameter> ofTechnique;
  std::copy_if(parameters.begin(), parameters.end(), std::back_inserter(ofTechnique),
               [&](const PublishedParameter& one) { return one.technique == request.id; });
  for (const std::string& name : request.names)
    page::found(ofTechnique, "pass with published values", name,
                [](const PublishedParameter& one) { return one.pass; });
  std::vector<Line> lines;
  for (const PublishedParameter& one : ofTechnique) {
    const auto& names = request.names;
    if (!names.empty() && std::find(names.begin(), names.end(), one.pass) == names.end()) continue;
    const auto same = std::find_if(lines.begin(), lines.end(), [&](const Line& line) {
      return line.name == one.name && line.published == one.published && line.ours == one.ours;
    });
    if (same == lines.end())
      lines.push_back({one.name, one.published, one.ours, {one.pass}});
    else
      same->passes.push_back(one.pass);
  }
  return table(lines);
}

}  // namespace

std::string withPublishedPassages(const std::string& markdown, const std::filesystem::path& file,
                                  const std::vector<PublishedParameter>& parameters) {
  return page::withPassages(markdown, file, "published", [&](const page::PassageRequest& request) {
    return passage(request, parameters);
  });
}

}  // namespace lumivox
