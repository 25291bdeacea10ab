#include "lumivox/results/runs.h"

#include <dlfcn.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/hash.h"
#include "lumivox/base/installation.h"

namespace lumivox {
namespace {

/// The larger over the smaller value, minus 1; 0 if one of them is not positive.
double apart(const Measured& a, const Measured& b) {
  if (!(a.value > 0.0) || !(b.value > 0.0)) return 0.0;
  return std::max(a.value, b.value) / std::min(a.value, b.value) - 1.0;
}

}  // namespace

std::string RunIdentity::key() const {
  Hasher hasher;
  hasher.add(sceneHash).add(pipelineHash).add(framework).add(std::uint64_t{techniques.size()});
  for (const auto& [name, hash] : techniques) hasher.add(name).add(hash);
  hasher.add(std::uint64_t{parameters.size()});
  for (const auto& [name, value] : parameters) hasher.add(name).add(value);
  hasher.add(camera).add(time).add(width).add(height).add(seed).add(seeds).add(repeats).add(subpixels);
  if (flickerPairs > 0) hasher.add("flicker").add(flickerPairs);
  for (const std::string& output : kept) hasher.add("kept").add(output);
  if (!display.empty()) hasher.add("display").add(display);
  hasher.add(referenceSamples).add(device).add(driver).add(shaderInput).add(host);
  return hasher.finish().text();
}

std::string RunIdentity::anywhere() const {
  RunIdentity work = *this;
  work.device = work.driver = work.shaderInput = work.host = {};
  return work.key();
}

std::string nodeName() {
  utsname system{};
  uname(&system);
  return system.nodename;
}

namespace {

/// The first number of a file of the system; NaN without one.
double numberIn(const std::filesystem::path& file) {
  std::ifstream stream(file);
  double value = 0.0;
  return stream >> value ? value : std::numeric_limits<double>::quiet_NaN();
}

double processorClockMhz() {
  constexpr double kMhzOfKiloHz = 1e-3;
  double sum = 0.0;
  int count = 0;
  const auto add = [&](double mhz) {
    if (!(mhz > 0.0)) return;
    sum += mhz;
    ++count;
  };
  const long processors = sysconf(_SC_NPROCESSORS_CONF);
  for (long i = 0; i < processors; ++i)
    add(kMhzOfKiloHz * numberIn(fmt::format("/sys/devices/system/cpu/cpu{}/cpufreq/scaling_cur_freq", i)));
  if (count == 0) {
    std::ifstream information("/proc/cpuinfo");
    for (std::string line; std::getline(information, line);)
      if (line.rfind("cpu MHz", 0) == 0 && line.find(": ") != std::string::npos)
        add(std::strtod(line.c_str() + line.find(": ") + 2, nullptr));
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / count;
}

/// The highest of the graphics cards that the kernel knows the clock of.
double deviceClockMhz() {
  constexpr double kMhzOfHz = 1e-6;
  double clock = std::numeric_limits<double>::quiet_NaN();
  std::error_code failure;
  for (std::filesystem::directory_iterator card("/sys/class/drm", failure), end; !failure && card != end;
       card.increment(failure)) {
    clock = std::fmax(clock, numberIn(card->path() / "gt_act_freq_mhz"));
    std::error_code none;
    for (std::filesystem::directory_iterator sensor(card->path() / "device/hwmon", none);
         !none && sensor != std::filesystem::directory_iterator(); sensor.increment(none))
      clock = std::fmax(clock, kMhzOfHz * numberIn(sensor->path() / "freq1_input"));
  }
  return clock;
}

}  // namespace

MachineState machineState() {
  return {numberIn("/proc/loadavg"), processorClockMhz(), deviceClockMhz()};
}

std::string frameworkHash() {
  static const std::string hash = [] {
    Hasher hasher;
    // The address of a function in each library tells its file.
    for (const void* inside :
         {reinterpret_cast<const void*>(&loadScene), reinterpret_cast<const void*>(&frameworkHash)}) {
      Dl_info information{};
      if (dladdr(inside, &information) == 0 || information.dli_fname == nullptr)
        throw Error("the framework's own libraries cannot be found, so results cannot be told apart");
      hasher.add(readFile(information.dli_fname, kLargestLibraryFile));
    }
    hasher.add(readFile(frameworkPack("toolkit")));  // techniques depend on it as on the library
    return hasher.finish().text();
  }();
  return hash;
}

std::string lumivoxVersion() {
  return fmt::format("{}, libraries {}", LUMIVOX_VERSION, frameworkHash());
}

TimeFloor timeFloorOf(const std::vector<RepeatedControl>& controls) {
  TimeFloor floor;
  floor.controls = static_cast<int>(controls.size());
  for (const RepeatedControl& control : controls) {
    floor.frame = std::max(floor.frame, apart(control.frameMs, control.frameMsAgain));
    floor.nextFrame = std::max(floor.nextFrame, apart(control.nextFrameMs, control.nextFrameMsAgain));
  }
  return floor;
}

TimeFloor larger(const TimeFloor& a, const TimeFloor& b) {
  return {std::max(a.frame, b.frame), std::max(a.nextFrame, b.nextFrame), a.controls + b.controls};
}

DeviceIdentity identityOf(const gpu::Device& device) {
  return {device.info().renderer, device.info().version, device.programRoute(), hostText()};
}

std::string hostText() {
  utsname system{};
  uname(&system);
  std::string processor;
  std::ifstream information("/proc/cpuinfo");
  for (std::string line; processor.empty() && std::getline(information, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
      processor = line.substr(line.find(": ") + 2);
  return fmt::format("{} {} {}, {} x {}", system.sysname, system.release, system.machine,
                     sysconf(_SC_NPROCESSORS_ONLN), processor.empty() ? "processor" : processor);
}

std::string dateText() {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(std::time(nullptr)));
}

}  // namespace lumivox
