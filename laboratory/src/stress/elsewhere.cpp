#include "stress/elsewhere.h"

#include <fmt/format.h>

#include "base/child.h"
#include "lumivox/base/error.h"

namespace lumivox::stress {

std::uint64_t askForContent(const Ground& ground, const ContentRequest& request,
                            const std::vector<std::string>& environment) {
  constexpr double kPatience = 60.0;  // s
  if (ground.program.empty()) throw Error("no program was given that another process could run");
  Child child(ground.program, environment);
  child.send(lineOf(request));
  Child::Answer answer = child.receive(kPatience);
  if (answer.state == Child::State::answered && readyFrom(answer.line)) answer = child.receive(kPatience);
  if (answer.state == Child::State::silent)
    throw std::runtime_error(fmt::format("another process gave no answer within {} s", kPatience));
  if (answer.state == Child::State::ended)
    throw std::runtime_error(fmt::format("another process {}: {}", child.ending(), child.lastWords()));
  const auto json = nlohmann::json::parse(answer.line);
  if (json.contains("unhealthy")) throw Unhealthy(json.at("unhealthy").get<std::string>());
  if (json.contains("error")) throw Error(json.at("error").get<std::string>());
  return json.at("content").get<std::uint64_t>();
}

}  // namespace lumivox::stress
