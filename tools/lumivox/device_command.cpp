// device: describes the device and measures its peak rates.
#include <fmt/format.h>

#include "command.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "lumivox/results/json.h"
#include "lumivox/results/store.h"
#include "lumivox/results/text.h"
#include "lumivox/roofline/peak_rates.h"

namespace lumivox::command {
namespace {

struct DeviceCommand {
  PeakRateOptions options;
  std::filesystem::path store;
  bool json = false;
};

int device(const DeviceCommand& command, const GlobalOptions& global) {
  PeakRateOptions options = command.options;
  Progress progress("peak rates", 0, "measured");
  options.progress = [&progress](std::size_t done, std::size_t total, const std::string& name) {
    progress.show(done, total, std::numeric_limits<double>::quiet_NaN(), name);
  };
  const std::filesystem::path file = command.store.empty() ? ResultsStore::defaultFile() : command.store;
  ResultsStore store(file);  // throws for a store that cannot be written, before the work
  const auto device = global.openDevice();
  const std::vector<PeakRate> peakRates = measurePeakRates(*device, options);
  store.add(peakRates);

  const gpu::DeviceInfo& info = device->info();
  if (command.json) {
    printJson({{"device",
                {{"vendor", info.vendor},
                 {"renderer", info.renderer},
                 {"version", info.version},
                 {"platform", info.platform},
                 {"software", info.software},
                 {"spirv", info.spirv},
                 {"timer_queries_trusted", info.timerQueriesTrusted},
                 {"timer_note", info.timerNote},
                 {"largest_volume", info.maxTextureSize3d},
                 {"largest_buffer_bytes", info.maxStorageBytes},
                 {"samples", info.maxSamples},
                 {"host", peakRates.front().host}}},
               {"store", file.string()},
               {"peak_rates", toJson(peakRates)}});
    return kGood;
  }
  std::string text = textTable({{"", ""},
                                {"Device", info.renderer + (info.software ? " (a software rasteriser)" : "")},
                                {"Vendor", info.vendor},
                                {"Driver", info.version},
                                {"Platform", info.platform},
                                {"Host", peakRates.front().host},
                                {"Shaders", gpu::programRouteText(*device)},
                                {"Timer", info.timerNote},
                                {"Largest volume", fmt::format("{} voxels a side", info.maxTextureSize3d)},
                                {"Largest buffer", formatBytes(info.maxStorageBytes)},
                                {"Samples per pixel", fmt::format("{}", info.maxSamples)}});
  std::vector<std::vector<std::string>> rows{{"At most", "median", "quartiles", "unit"}};
  for (const PeakRate& peakRate : peakRates)
    rows.push_back(
        {peakRate.name, formatThousands(peakRate.rate.median),
         formatThousands(peakRate.rate.lowerQuartile) + " .. " + formatThousands(peakRate.rate.upperQuartile),
         peakRate.unit});
  print(text + "\n" + textTable(rows) + file.string() + "\n");
  return kGood;
}

}  // namespace

void addDeviceCommand(Commands& commands) {
  auto* command =
      commands.app.add_subcommand("device", "measures the peak rates of this device and stores them");
  auto all = std::make_shared<DeviceCommand>();
  command->add_option("--store", all->store,
                      "the results store (default: $LUMIVOX_RESULTS, else results.sqlite in the cache)");
  command->add_option("--repeats", all->options.repeats, "timed runs per peak rate (default 5)")
      ->check(CLI::Range(1, 10000));
  addRepeatable(*command, "--only", all->options.names, "measures this peak rate alone; may be repeated");
  command->add_flag("--json", all->json, "print JSON in place of the table");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return device(*all, global); });
}

}  // namespace lumivox::command
