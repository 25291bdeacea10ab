// The worker's side of the battery.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "lumivox/experiment/report.h"
#include "lumivox/results/stress_cells.h"
#include "stress/protocol.h"
#include "stress/run_cell.h"

namespace lumivox {
namespace {

using namespace stress;
using Json = nlohmann::ordered_json;

/// Reserves standard output for answers; output of drivers and libraries goes to standard error.
class Answers {
 public:
  Answers() : file_(fdopen(dup(STDOUT_FILENO), "w")) {
    if (file_ == nullptr) throw Error("a stress worker has no standard output");
    std::fflush(stdout);
    dup2(STDERR_FILENO, STDOUT_FILENO);
  }
  ~Answers() { std::fclose(file_); }
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;
  void write(const std::string& line) {
    if (std::fputs((line + "\n").c_str(), file_) < 0 || std::fflush(file_) != 0)
      throw Error("a stress worker cannot write its answer");
  }

 private:
  FILE* file_;
};

std::string contentAnswer(Ground& ground, const ContentRequest& request) {
  try {
    const Pipeline pipeline = Pipeline::load(request.pipeline);
    ground.quick = request.quick;
    PipelineBench bench(ground, pipeline);
    return Json{{"content", bench.contentOf(bench.committedScene(request.committedScene), request.shot)}}
        .dump();
  } catch (const Unhealthy& bad) {
    return Json{{"unhealthy", bad.what()}}.dump();
  } catch (const Error& error) {
    return Json{{"error", error.what()}}.dump();
  }
}

}  // namespace

void serveStress(const StressWorker& worker, TechniqueSource& techniques) {
  Answers answers;
  // The scenes that come with the program, since a user's project has others or none.
  const auto stress = programData("scenes/stress");
  if (!stress) throw Error("the scenes that stress cases are made from are missing; expected scenes/stress");
  gpu::Device device(worker.device);
  Ground ground{device,         worker.device, techniques, worker.sceneLoad, stress->parent_path(),
                worker.program, false};
  answers.write(lineOf(workerDeviceOf(device)));
  for (std::string line; std::getline(std::cin, line);) {
    const AnyRequest request = requestOf(line);
    answers.write(request.cell ? stressCellJson(runCell(ground, *request.cell, worker.repeatArguments))
                               : contentAnswer(ground, *request.content));
  }
}

}  // namespace lumivox
