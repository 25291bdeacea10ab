// Statements that need the window: clicks, keys, shots, and waiting.
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <set>

#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "viewer/window_state.h"

namespace lumivox::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLongestWait = 60.0;  // s, of a script's `wait`
constexpr int kFramesOfPress = 1;      // more frames, if slow, would repeat the key

}  // namespace

void Window::State::feedClick() {
  if (!click) return;
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = click->at;
  io.MouseDown[0] = click->frame == 2;
  soon = 3;
  if (++click->frame > 4) click.reset();
}

void Window::State::feedPress() {
  if (!press) return;
  ImGui::GetIO().KeysDown[press->key] = press->frame < kFramesOfPress;
  soon = 3;
  if (++press->frame > kFramesOfPress) press.reset();
}

bool Window::State::waitIsOver(const Action& action) {
  const std::string what = action.text();
  if (std::chrono::duration<double>(Clock::now() - waitsSince).count() > kLongestWait)
    throw Error(fmt::format("{}: `{}` took more than {} s; {}", action.place().text(), action.written(),
                            kLongestWait, session->problem()));
  if (what == "frame") return session->settled();
  if (what == "judged") return session->judgedNow();
  if (what == "problem") return !session->problem().empty();
  if (what == "kept") {
    if (!session->keeping() && session->messageIsError()) throw Error(session->message());
    return !session->keeping();
  }
  if (what == "mended") return session->problem().empty();
  if (what == "reference") {
    const ReferenceResult reference = session->reference();
    const int wanted = action.property->values.size() > 1 ? static_cast<int>(action.number(1)) : 2;
    return session->settled() && reference != nullptr && reference->samples >= wanted;
  }
  throw Error(fmt::format("{}: wait {}: expected frame, judged, problem, mended, kept or reference",
                          action.place().text(), what));
}

void Window::State::resize(int width, int height) {
  glfwSetWindowSize(window, width, height);
  soon = 4;
}

bool Window::State::doInWindow(const Action& action) {
  const std::string& word = action.word();
  if (word == "click") {
    const auto found = controls.find(action.text());
    if (found == controls.end()) {
      std::vector<std::string> names;
      for (const auto& [name, place] : controls) names.push_back(name);
      const std::string nearest = nearestWord(action.text(), names);
      throw Error(fmt::format("{}: click '{}': there is no such control in the open panel '{}'{}",
                              action.place().text(), action.text(), openPanel,
                              nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    const Rectangle& at = found->second;
    click = {ImVec2(0.5f * (at.low.x + at.high.x), 0.5f * (at.low.y + at.high.y)), 0};
    // The rectangle of a check box includes its label, so its middle may miss the box.
    click->at.x = std::min(click->at.x, at.low.x + 10.0f * scale);
  } else if (word == "key") {
    for (const KeyStatement& one : keyStatements())
      if (one.name == action.text()) return key(one), true;
    for (const auto& [name, code] : heldKeys())
      if (name == action.text()) {
        press = Press{code, 0};
        return true;
      }
    throw Error(fmt::format("{}: key '{}': nothing is bound to it", action.place().text(), action.text()));
  } else if (word == "panel") {
    wantedPanel = action.text();
    if (std::none_of(panels.begin(), panels.end(), [&](const Panel& one) { return one.name == wantedPanel; }))
      throw Error(fmt::format("{}: there is no panel '{}'", action.place().text(), wantedPanel));
    soon = 4;
  } else if (word == "window") {
    const std::vector<double> n = action.numbers();
    resize(static_cast<int>(n[0]), static_cast<int>(n[1]));
  } else if (word == "panels") {
    showsPanels = action.flag();
    session->showPanels(showsPanels);
    soon = 4;
  } else if (word == "panel_width") {
    panelWidth = static_cast<float>(action.number());
    soon = 4;
  } else if (word == "scale") {
    rescale(static_cast<float>(action.number()));
  } else if (word == "copy_command") {
    glfwSetClipboardString(window, session->command().c_str());
    session->say("the command is in the clipboard", false);
  } else if (word == "minimise") {
    minimise(action.flag());
  } else if (word == "focus") {
    focus = action.text();
    soon = 4;
  } else if (word == "shot") {
    shoot(action.text());
  } else if (word == "random") {
    randomActions(static_cast<int>(action.number()));
  } else if (word == "quit") {
    glfwSetWindowShouldClose(window, GLFW_TRUE);
  } else {
    return false;
  }
  return true;
}

void Window::State::randomActions(int count) {
  std::mt19937_64 random(session->state().seed);
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    panels = panelsOf(*session);
    const Panel& panel = panels[random() % panels.size()];
    if (panel.name == "keep" || panel.rows.empty()) continue;  // writes no files
    session->say({}, false);
    const Row& row = panel.rows[random() % panel.rows.size()];
    std::string statement = row.statement;
    if (row.kind == Row::Kind::choice && !row.choices.empty())
      statement = filledIn(statement, choiceValue(row.choices[random() % row.choices.size()]));
    if (row.kind == Row::Kind::toggle) statement = filledIn(statement, random() % 2 == 0 ? "on" : "off");
    // Small values, so that a long script does not wait for huge grids.
    const auto value = [&] {
      const double share = static_cast<double>(random() % 1000) / 999.0;
      return row.low + share * (std::min(row.high, row.low + 64.0) - row.low);
    };
    if (row.kind == Row::Kind::number)
      statement =
          filledIn(statement, row.integer ? fmt::format("{:.0f}", value()) : fmt::format("{}", value()));
    if (row.kind == Row::Kind::triple) statement = filledIn(statement, written({value(), value(), value()}));
    if (!row.resets.empty() && random() % 4 == 0)
      statement = row.resets[random() % row.resets.size()].statement;
    if (!statement.empty()) act(statement);
    // A control may ask for something that is refused, such as a surface that reflects more than it receives.
    if (session->messageIsError()) ++refused;
    session->step(0.01);
  }
  session->say(fmt::format("{} random actions, of which {} were refused", count, refused), false);
}

void Window::State::shoot(const std::filesystem::path& file) {
  const command::Outputs outputs = command::Outputs().add("shot", file, {".png"});
  outputs.check({});
  outputs.requireUnread();
  int width = 0, height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  std::vector<unsigned char> bytes(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
  ImageBuffer pixels(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        pixels.at(x, y, c) =
            static_cast<float>(
                bytes[4 * (static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x)) +
                      static_cast<std::size_t>(c)]) /
            255.0f;
  writePng(file, pixels, {0.0, Tone::linear});
}

/// Performs statements until one must wait. Returns whether any is left.
bool Window::State::advanceScript() {
  while (done < script.size() && !busyWithHands() && soon == 0) {
    const Action& action = script[done];
    static const std::set<std::string> looks{"answer", "click", "key", "record", "shot", "wait"};
    if (!session->question().empty() && looks.count(action.word()) == 0)
      throw Error(fmt::format("{}: {}: {} Expected `answer yes` or `answer no`", action.place().text(),
                              action.written(), session->question()));
    if (action.word() == "wait") {
      if (!waits) waitsSince = Clock::now();
      waits = true;
      if (!waitIsOver(action)) return true;
      waits = false;
    } else {
      session->say(session->message(), false);  // clears the error flag
      try {
        if (!session->perform(action)) doInWindow(action);
      } catch (const std::exception& error) {
        const std::string what = error.what(), at = action.place().text();
        if (what.starts_with(at)) throw;
        throw Error(fmt::format("{}: {}: {}", at, action.written(), what));
      }
      if (session->messageIsError())
        throw Error(fmt::format("{}: {}: {}", action.place().text(), action.written(), session->message()));
      soon = std::max(soon, 2);
    }
    ++done;
  }
  return done < script.size();
}

}  // namespace lumivox::viewer
