// A measured point with everything that it depends on.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/results/records.h"

namespace lumivox {

/// Everything that a result depends on. Two runs with the same identity measure the same thing, so that the
/// second is not run.
struct RunIdentity {
  std::string sceneHash, pipelineHash;            ///< of the texts with all that they include and name
  std::map<std::string, std::string> techniques;  ///< name to hash of library and shader pack
  std::string framework;                          ///< hash of the framework's own libraries
  std::map<std::string, std::string> parameters;  ///< all parameters of the pipeline, as settings
  std::string camera;
  double time = 0.0;  ///< s
  int width = 0, height = 0;
  std::uint64_t seed = 1;
  int seeds = 1, repeats = 1, subpixels = 1, referenceSamples = 0;
  int flickerPairs = 0;           ///< 0 where the scene does not move
  std::vector<std::string> kept;  ///< sorted outputs "pass.port" that no image needs
  /// How its images are displayed, where that is not as usual: "exposure -2, tone filmic".
  std::string display;
  std::string device, driver, shaderInput, host;  ///< host: processor and system

  std::string key() const;  ///< 32 hexadecimal digits
  /// The same for whatever machine measures it: two runs with it differ in device, driver, shader input or
  /// host at most.
  std::string anywhere() const;
};

/// How busy the machine of a measurement was and how fast it ran; NaN where the system does not say.
struct MachineState {
  double load = std::numeric_limits<double>::quiet_NaN();            ///< runnable processes, mean of a minute
  double clockMhz = std::numeric_limits<double>::quiet_NaN();        ///< of the processors, their mean
  double deviceClockMhz = std::numeric_limits<double>::quiet_NaN();  ///< of the GPU's cores
};
MachineState machineState();
/// The machine's name in its network.
std::string nodeName();

/// One record of the store.
struct StoredRun {
  std::int64_t id = 0;  ///< in its store; 0 before it is stored
  RunIdentity identity;
  std::string created;  ///< "2015-10-21 16:29:00 UTC"
  std::string version;  ///< of lumivox
  std::string sceneName, pipelineName;
  bool isDefault = false;      ///< every parameter as the text has it
  ReportPoint point;           ///< `command` repeats it; a point with `failure` has no numbers
  std::string node;            ///< machine that took its times
  double seconds = 0.0;        ///< that measuring it took
  MachineState before, after;  ///< of its times
};

/// The times of a stored run measured once more, later: any difference is variation of the machine.
struct RepeatedControl {
  std::string created;            ///< "2015-10-21 16:29:00 UTC"
  Measured frameMs, nextFrameMs;  ///< of the run
  Measured frameMsAgain, nextFrameMsAgain;
};

/// The largest difference between repeated times of the same run on one machine, as a share of the smaller.
struct TimeFloor {
  double frame = 0.0, nextFrame = 0.0;
  int controls = 0;  ///< that say so; 0: not examined
};
/// The largest of the controls.
TimeFloor timeFloorOf(const std::vector<RepeatedControl>& controls);
/// The larger of both, for numbers of both.
TimeFloor larger(const TimeFloor& a, const TimeFloor& b);

/// An image of a run: an output, or its FLIP map against a layer of the reference.
struct StoredImage {
  std::string output, component;
  std::string reference;  ///< layer of the map; empty: the output itself
  double flip = 0.0;      ///< mean of the map
  std::string png;
};

/// Hash of the framework's libraries as they are loaded: part of every identity.
std::string frameworkHash();

/// This version and its libraries, as ResultsStore::versions() names them.
std::string lumivoxVersion();

/// The machine that times depend on, besides the work.
struct DeviceIdentity {
  std::string device, driver, shaderInput, host;
};
DeviceIdentity identityOf(const gpu::Device& device);
/// System and processor.
std::string hostText();
/// Now, as "2015-10-21 16:29:00 UTC".
std::string dateText();

}  // namespace lumivox
