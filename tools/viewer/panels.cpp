#include "viewer/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/reasons.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/text.h"
#include "viewer/panel_rows.h"

namespace lumivox::viewer {
namespace {

using Kind = Row::Kind;

/// `none`: the text for a number that is not finite.
std::string measuredText(const Measured& value, const std::string& none) {
  if (!std::isfinite(value.value)) return none;
  if (!std::isfinite(value.uncertainty)) return fmt::format("{:.4g}", value.value);
  return fmt::format("{:.4g} ± {:.2g}", value.value, value.uncertainty);
}

/// The errors of one output; FLIP comes first, as on the page of a report.
void addJudged(std::vector<Row>& rows, const JudgedOutput& one, const std::string& prefix) {
  const std::string name = prefix + one.output, noPixel = "none: no pixel is a number in both images";
  const ImageError& error = one.error;
  const double overNothing = error.flip / one.ofNothing;
  rows.push_back(text(name + " layer", one.output, "against " + one.layer));
  rows.push_back(text(name + " flip", "  FLIP", measuredText({error.flip, error.flipUncertainty}, noPixel)));
  rows.push_back(text(name + " of nothing", "  over that of none",
                      std::isfinite(overNothing) ? fmt::format("{:.3f}", overNothing) : "-",
                      "the FLIP over that of leaving the output out"));
  rows.push_back(text(name + " rmse", "  RMSE", measuredText(error.rmse, noPixel)));
  rows.push_back(
      text(name + " mean ratio", "  mean ratio",
           measuredText(error.meanRatio,
                        std::isfinite(error.rmse.value) ? "none: the reference is black" : noPixel)));
  rows.push_back(text(name + " noise", "  noise of the reference",
                      std::isfinite(error.noiseFloor) ? fmt::format("{:.3g}", error.noiseFloor) : noPixel));
}

std::vector<std::string> stemsOf(const Session& session) {
  std::vector<std::string> names;
  for (const auto& pipeline : session.pipelines()) names.push_back(pipeline->file.stem().string());
  return names;
}

/// Rows for the shown port: its texture, field and level, with the choices for each.
void addPort(std::vector<Row>& rows, const Session& session, const std::vector<std::string>& textures,
             const std::vector<std::string>& fields) {
  const PortChoice& port = *session.state().port;
  const RenderedResult rendered = session.rendered();
  static const PortPicture nothing;
  const PortPicture& shown = rendered == nullptr ? nothing : rendered->port;
  if (!textures.empty())
    rows.push_back(choice("texture", "texture", port.texture.empty() ? textures.front() : port.texture,
                          textures, "texture {}"));
  if (fields.size() > 1)
    rows.push_back(choice("voxels", "voxels", port.field.empty() ? "nothing" : port.field, fields,
                          "voxels {}", "a field of the voxels as cubes, or spherical harmonics as lobes"));
  rows.push_back(number("level", "level", port.level, 0, std::max(0, shown.levels - 1), true, "level {}"));
  if (!shown.brightness.empty()) {
    rows.push_back(number("above", "voxels above", port.above, 0, 1, false, "above {}",
                          "voxels are shown only if their value is above it"));
    rows.push_back(number("see_through", "see through", session.state().seeThrough, 0, 1, false,
                          "see_through {}", "how much of the picture is seen behind the voxels"));
    const auto& brightness = shown.brightness.values();
    const auto pixels =
        brightness.size() - static_cast<std::size_t>(std::count(brightness.begin(), brightness.end(), 0.0f));
    rows.push_back(text("voxel_pixels", "pixels with voxels", fmt::format("{}", pixels)));
  } else {
    rows.push_back(number("slice", "slice", port.slice, 0, std::max(0, shown.slices - 1), true, "slice {}"));
    rows.push_back(choice("channel", "components", channelWords()[static_cast<std::size_t>(port.channel)],
                          channelWords(), "channel {}"));
  }
  if (!shown.quantity.empty())
    rows.push_back(text("quantity", shown.shown,
                        shown.quantity + (shown.unit.empty() || shown.unit == "1" ? "" : ", " + shown.unit)));
}

Panel lookPanel(const Session& session) {
  const ViewState& state = session.state();
  Panel panel{"look", "Look", {}};
  std::vector<Row>& rows = panel.rows;
  rows.push_back(choice("pipeline", "pipeline", state.sides.front().pipeline->file.stem().string(),
                        stemsOf(session), "show {}"));
  std::vector<std::string> seconds = stemsOf(session);
  seconds.insert(seconds.begin(), {"nothing", "copy"});
  rows.push_back(choice("beside", "beside",
                        state.sides.size() < 2 ? "nothing" : state.sides[1].pipeline->file.stem().string(),
                        seconds, "beside {}", "a second pipeline, rendered in the same frame"));
  std::vector<std::string> cameras;
  for (const Camera& camera : session.scene().cameras) cameras.push_back(camera.name);
  rows.push_back(choice("camera", "camera", state.free ? "free" : state.camera, cameras, "camera {}",
                        "W A S D Q E move, the left button turns, the right one orbits"));
  rows.push_back(number("time", "time, s", state.time, 0.0, 60.0, false, "time {}"));
  rows.push_back(toggle("play", "play", state.plays, "play {}"));
  rows.push_back(number("loop", "loop after, s", state.loop, 0.0, 60.0, false, "loop {}", "0: time goes on"));
  std::vector<std::string> frames{"all"};
  for (const Object& object : session.scene().objects) frames.push_back(object.name);
  rows.push_back(choice("frame", "frame", "", frames, "frame {}", "steps back until it is seen whole"));
  std::vector<std::string> outputs{kWholeImage};
  for (const Pipeline::Output& output : state.sides.front().pipeline->outputs) outputs.push_back(output.name);
  rows.push_back(choice("output", "output", state.output, outputs, "output {}"));
  std::vector<std::string> ports{"nothing"}, textures, fields{"nothing"};
  if (const RenderedResult rendered = session.rendered(); rendered != nullptr && !rendered->sides.empty())
    for (const PassContract& pass : rendered->sides.front().contracts)
      for (const PassContract::Port& port : pass.outputs) {
        if (port.textures.empty() && port.fields.empty()) continue;
        ports.push_back(pass.name + "." + port.name);
        if (!state.port || state.port->pass != pass.name || state.port->port != port.name) continue;
        textures = port.textures;
        fields.insert(fields.end(), port.fields.begin(), port.fields.end());
      }
  rows.push_back(choice("port", "port", state.port ? state.port->pass + "." + state.port->port : "nothing",
                        ports, "port {}", "any texture of any output of a pass"));
  if (state.port) addPort(rows, session, textures, fields);
  rows.push_back(choice("layout", "layout", layoutWords()[static_cast<std::size_t>(state.layout)],
                        layoutWords(), "layout {}"));
  rows.push_back(number("split", "split", state.split, 0, 1, false, "split {}"));
  rows.push_back(choice("error_map", "error", errorMapWords()[static_cast<std::size_t>(state.errorMap)],
                        errorMapWords(), "error_map {}"));
  rows.push_back(number("exposure", state.exposure ? "exposure, EV" : "exposure, EV (automatic)",
                        session.exposure(), -20, 20, false, "exposure {}"));
  rows.push_back(button("exposure_auto", "automatic exposure", "exposure auto"));
  rows.push_back(
      choice("tone", "tone", curveWords()[static_cast<std::size_t>(state.curve)], curveWords(), "tone {}"));
  const Picture& picture = session.picture();
  if (!picture.legends.empty()) {
    std::vector<std::string> legends;
    for (const Legend& legend : picture.legends) legends.push_back(legend.text);
    rows.push_back(text("legend", "legend", fmt::format("{}", fmt::join(legends, "; "))));
  }
  rows.push_back(text("bad_pixels", "NaN or infinite pixels", fmt::format("{}", picture.badPixels)));
  rows.push_back(text("size", "size", fmt::format("{} x {}", state.width, state.height)));
  return panel;
}

Panel judgePanel(const Session& session) {
  const ViewState& state = session.state();
  Panel panel{"judge", "Judge", {}};
  panel.rows.push_back(toggle("reference", "trace a reference", state.traces, "reference {}"));
  const ReferenceResult reference = session.reference();
  panel.rows.push_back(text("samples", "samples",
                            reference == nullptr
                                ? std::string("none yet")
                                : fmt::format("{} of {}, {:.1f} s{}", reference->samples, state.samples,
                                              reference->seconds, session.tracing() ? "" : ", done")));
  if (const auto judged = session.judged()) {
    for (std::size_t i = 0; i < judged->sides.size(); ++i) {
      panel.rows.push_back(heading(judged->wish.rendered->wish.sides[i].pipeline->file.stem().string() +
                                   (i == 0 ? "" : " (beside)")));
      for (const JudgedOutput& one : judged->sides[i]) addJudged(panel.rows, one, i == 0 ? "" : "beside ");
    }
  }
  Row chart;
  chart.kind = Kind::points;
  chart.name = "tried";
  chart.label = "FLIP of the whole image against time, ms";
  for (const TriedPoint& point : session.tried()) {
    if (!point.error || !std::isfinite(point.error->value) || point.frameMs <= 0.0) continue;
    std::string statement = "show " + quoted(point.side.pipeline->file.stem().string());
    if (!point.side.values.empty()) {
      statement += "\nset {";
      for (const auto& [name, value] : point.side.values) statement += " " + name + " " + value.text();
      statement += " }";
    }
    chart.marks.push_back({point.label, point.frameMs, point.error->value, statement});
  }
  panel.rows.push_back(std::move(chart));
  return panel;
}

Panel needPanel(const Session& session) {
  Panel panel{"need", "Need", {}};
  panel.rows.push_back(toggle("keep_everything", "keep everything", session.state().keepEverything,
                              "keep_everything {}", "K"));
  const RenderedResult rendered = session.rendered();
  if (rendered == nullptr || !rendered->sides.front().error.empty()) return panel;
  const Explanation& explanation = rendered->sides.front().explanation;
  panel.rows.push_back(
      text("passes", "passes", fmt::format("{} of {}", explanation.passesKept, explanation.passesTotal)));
  panel.rows.push_back(text("variants", "variants of shaders",
                            fmt::format("{} needed, {} compiled, {} possible", explanation.variantsNeeded,
                                        explanation.variantsCompiled, explanation.variantsPossible)));
  panel.rows.push_back(text("memory", "memory of passes",
                            fmt::format("{}, {} saved by sharing", formatBytes(explanation.poolBytes),
                                        formatBytes(explanation.sharedBytes))));
  // Passes and resources come first, since variants and libraries are many.
  std::vector<command::Reason> reasons = command::reasonsOf(explanation);
  const auto order = [](const command::Reason& reason) {
    return reason.level == LeftOut::Level::plugin ? 2 : reason.level == LeftOut::Level::variant ? 1 : 0;
  };
  std::stable_sort(reasons.begin(), reasons.end(),
                   [&](const command::Reason& a, const command::Reason& b) { return order(a) < order(b); });
  constexpr std::size_t kNamed = 4;
  for (const command::Reason& reason : reasons) {
    std::vector<std::string> what = reason.what;
    if (what.size() > kNamed) {
      what.resize(kNamed);
      what.push_back(fmt::format("{} more", reason.what.size() - kNamed));
    }
    panel.rows.push_back(text(fmt::format("left out, {}: {}", name(reason.level), reason.why),
                              fmt::format("{} {}", name(reason.level), fmt::join(what, ", ")),
                              reason.why + (reason.bytes > 0 ? ", " + formatBytes(reason.bytes) : "")));
  }
  return panel;
}

Panel keepPanel(const Session& session) {
  Panel panel{"keep", "Keep", {}};
  panel.rows.push_back(button("save_png", "picture as PNG", "save_image \"out/view.png\""));
  panel.rows.push_back(button("save_exr", "all outputs as EXR", "save_image \"out/view.exr\""));
  panel.rows.push_back(button("shot", "the window as PNG", "shot \"out/window.png\""));
  if (session.state().port)
    panel.rows.push_back(button("export_grid", "the port's voxels as VDB", "export_grid \"out/view.vdb\""));
  panel.rows.push_back(button("add_point", "measure, into a results store",
                              "add_point \"out/results.sqlite\"",
                              "as `sweep` does: with errors, times and where they come from"));
  panel.rows.push_back(button("record", "the panels as JSON", "record \"out/view.json\""));
  panel.rows.push_back(button(
      "save_pipeline", "parameters into the pipeline's text",
      "save_pipeline " + quoted(session.state().sides.front().pipeline->file.string()), "asks before"));
  panel.rows.push_back(button("save_scene", "edits and camera into the scene's text",
                              "save_scene " + quoted(session.scene().file.string()), "asks before"));
  panel.rows.push_back(
      button("copy_command", "the command that repeats this picture, to paste", "copy_command on"));
  try {
    panel.rows.push_back(text("command", "command", session.command(), "repeats this picture"));
  } catch (const Error& why) {
    panel.rows.push_back(text("command", "command", why.what()));
  }
  panel.rows.push_back(heading("done so far, as a script"));
  const std::vector<std::string> history = session.history();
  constexpr std::size_t kShown = 20;
  for (std::size_t i = history.size() > kShown ? history.size() - kShown : 0; i < history.size(); ++i)
    panel.rows.push_back(text(fmt::format("done {}", i), {}, history[i]));
  return panel;
}

const char* wordOf(Kind kind) {
  switch (kind) {
    case Kind::heading:
      return "heading";
    case Kind::text:
      return "text";
    case Kind::number:
      return "number";
    case Kind::triple:
      return "triple";
    case Kind::choice:
      return "choice";
    case Kind::toggle:
      return "toggle";
    case Kind::button:
      return "button";
    case Kind::bars:
      return "bars";
    case Kind::stacks:
      return "stacks";
    case Kind::points:
      return "points";
  }
  return "";
}

}  // namespace

std::vector<Panel> panelsOf(const Session& session) {
  return {lookPanel(session),   judgePanel(session), timePanel(session), needPanel(session),
          changePanel(session), scenePanel(session), keepPanel(session)};
}

nlohmann::ordered_json recordOf(const Session& session) {
  using Json = nlohmann::ordered_json;
  Json panels = Json::object();
  for (const Panel& panel : panelsOf(session)) {
    Json rows = Json::array();
    for (const Row& row : panel.rows) {
      Json one = {{"name", row.name}, {"kind", wordOf(row.kind)}, {"label", row.label}};
      if (!row.value.empty()) one["value"] = row.value;
      if (!row.tooltip.empty()) one["tooltip"] = row.tooltip;
      if (!row.statement.empty()) one["statement"] = row.statement;
      if (!row.choices.empty()) one["choices"] = row.choices;
      if (row.kind == Kind::number || row.kind == Kind::triple) one["range"] = {row.low, row.high};
      for (const Row::Reset& reset : row.resets) one["resets"][reset.word] = reset.statement;
      if (row.changed) one["changed"] = true;
      for (const Row::Mark& mark : row.marks)
        one["marks"].push_back({{"label", mark.label}, {"x", mark.x}, {"y", mark.y}});
      rows.push_back(std::move(one));
    }
    panels[panel.name] = std::move(rows);
  }
  return {{"problem", session.problem()},  {"message", session.message()},   {"settled", session.settled()},
          {"judged", session.judgedNow()}, {"question", session.question()}, {"panels", std::move(panels)}};
}

std::string written(const std::array<double, 3>& numbers) {
  return fmt::format("{} {} {}", numbers[0], numbers[1], numbers[2]);
}

std::string filledIn(const std::string& statement, const std::string& value) {
  std::string result = statement;
  if (const std::size_t at = result.find("{}"); at != std::string::npos) result.replace(at, 2, value);
  return result;
}

}  // namespace lumivox::viewer
