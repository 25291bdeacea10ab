#include "stress/run_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <new>

#include "experiment/choice.h"
#include "experiment/plan.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "stress/cards.h"

namespace lumivox::stress {
namespace {

std::string repeatingCommand(const CellRequest& request, const std::vector<std::string>& repeatArguments) {
  std::string command = fmt::format(
      "lumivox stress --case {} --pipeline {}{}", experiment::shellQuoted(request.name),
      experiment::shellQuoted(experiment::shownPath(request.pipeline)), request.quick ? " --quick" : "");
  for (const std::string& argument : repeatArguments) command += " " + experiment::shellQuoted(argument);
  return command;
}

void fillIn(StressCell& cell, Finding finding) {
  cell.outcome = finding.outcome;
  cell.measure = std::move(finding.measure);
  cell.unit = std::move(finding.unit);
  cell.value = finding.value;
  cell.limit = finding.limit;
  cell.detail = std::move(finding.detail);
}

void end(StressCell& cell, StressOutcome outcome, std::string detail) {
  cell.outcome = outcome;
  cell.detail = std::move(detail);
}

/// An Error is a refusal of bad input; any other exception was not foreseen.
void runGuarded(const Case& one, Bench& bench, StressCell& cell) {
  try {
    std::optional<Finding> finding = one.run(bench);
    if (finding)
      fillIn(cell, std::move(*finding));
    else
      cell.outcome = StressOutcome::notApplicable;
  } catch (const Unhealthy& bad) {
    end(cell, StressOutcome::broken, bad.what());
  } catch (const AbsentError& absent) {
    end(cell, StressOutcome::notApplicable, absent.what());
  } catch (const Error& refusal) {
    end(cell, StressOutcome::refused, refusal.what());
  } catch (const std::bad_alloc&) {
    end(cell, StressOutcome::broken, "out of memory; what was too large is not known");
  } catch (const std::exception& error) {
    end(cell, StressOutcome::broken, fmt::format("an unexpected error: {}", error.what()));
  }
}

}  // namespace

void describeDevice(StressCell& cell, const WorkerDevice& device) {
  cell.device = device.device;
  cell.driver = device.driver;
  cell.shaderInput = device.shaderInput;
}

StressCell cellBefore(const CellRequest& request, const std::string& family, TechniqueSource& techniques,
                      const std::vector<std::string>& repeatArguments) {
  const Pipeline pipeline = Pipeline::load(request.pipeline);
  StressCell cell;
  cell.created = dateText();
  cell.version = LUMIVOX_VERSION;
  cell.family = family;
  cell.name = request.name;
  cell.pipeline = experiment::shownPath(request.pipeline);
  cell.technique = techniqueOf(pipeline, techniques);
  cell.size = request.quick ? "quick" : "full";
  cell.command = repeatingCommand(request, repeatArguments);
  cell.pipelineHash = pipeline.hash.text();
  cell.framework = frameworkHash();
  for (const std::string& name : pipeline.techniques())
    if (const Technique* technique = techniques.technique(name))
      cell.techniques[name] = technique->hash.text() + "+" + technique->shaders.hash.text();
  cell.host = hostText();
  return cell;
}

StressCell runCell(Ground& ground, const CellRequest& request,
                   const std::vector<std::string>& repeatArguments) {
  const Pipeline pipeline = Pipeline::load(request.pipeline);
  const std::vector<Case> cases = casesFor(pipeline, ground.techniques);
  const auto one =
      std::find_if(cases.begin(), cases.end(), [&](const Case& c) { return c.info.name == request.name; });
  if (one == cases.end())
    throw Error(fmt::format("{}: there is no stress case '{}' for this pipeline", request.pipeline.string(),
                            request.name));
  StressCell cell = cellBefore(request, one->info.family, ground.techniques, repeatArguments);
  describeDevice(cell, workerDeviceOf(ground.device));
  ground.quick = request.quick;
  PipelineBench bench(ground, pipeline);
  if (!request.image.empty()) bench.meterScenes();
  const auto start = std::chrono::steady_clock::now();
  runGuarded(*one, bench, cell);
  cell.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  CardAnswer answer = explanationOf(cell, pipeline, ground.techniques);
  cell.explanation = std::move(answer.explanation);
  if (!answer.contradiction.empty()) cell.detail += (cell.detail.empty() ? "" : "; ") + answer.contradiction;
  const ImageBuffer& image = bench.shown();
  if (!request.image.empty() && !image.empty()) {
    createParentDirectories(request.image);
    writePng(request.image, image, {bench.exposure(), kShownTone});
    cell.image = (request.image.parent_path().filename() / request.image.filename()).string();
  }
  return cell;
}

}  // namespace lumivox::stress
