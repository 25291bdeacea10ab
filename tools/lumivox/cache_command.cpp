// cache: the path-traced references that are stored for later runs.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/reference/reference_cache.h"

namespace lumivox::command {
namespace {

struct CacheCommand {
  std::string limit;
  double unusedDays = -1.0;
  bool all = false, dryRun = false, json = false;
};

std::string timeText(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(std::chrono::system_clock::to_time_t(time)));
}

std::string attribute(const KeptReference& kept, const char* name) {
  const auto found = kept.attributes.find(name);
  return found == kept.attributes.end() ? "-" : found->second;
}

int list(const CacheCommand& command) {
  const std::vector<KeptReference> kept = keptReferences();
  std::uint64_t sizeBytes = 0;
  std::vector<std::vector<std::string>> rows{
      {"Scene", "Camera", "Resolution", "Samples", "Bounces", "Time s", "Size", "Last used", "File"}};
  Json entries = Json::array();
  for (const KeptReference& one : kept) {
    sizeBytes += one.sizeBytes;
    rows.push_back({one.attributes.empty() ? "(damaged)" : attribute(one, "scene"), attribute(one, "camera"),
                    attribute(one, "resolution"), attribute(one, "samples"), attribute(one, "bounces"),
                    attribute(one, "time"), formatBytes(one.sizeBytes), timeText(one.used),
                    one.file.filename().string()});
    entries.push_back({{"file", one.file.string()},
                       {"bytes", one.sizeBytes},
                       {"last_used", timeText(one.used)},
                       {"damaged", one.attributes.empty()},
                       {"attributes", one.attributes}});
  }
  const std::uint64_t limit = referenceCacheLimit();
  if (command.json) {
    printJson({{"folder", cacheDirectory().string()},
               {"limit_bytes", limit},
               {"bytes", sizeBytes},
               {"references", entries}});
  } else {
    if (!kept.empty()) print(textTable(rows));
    print(fmt::format("{}: {} references, {} of at most {}\n", cacheDirectory().string(), kept.size(),
                      formatBytes(sizeBytes), formatBytes(limit)));
  }
  return kGood;
}

int prune(const CacheCommand& command) {
  std::uint64_t limit = command.all ? 0 : referenceCacheLimit();
  if (!command.limit.empty()) {
    const auto given = parseBytes(command.limit);
    if (!given)
      throw Error(fmt::format("--limit '{}': expected a size such as 500MiB or 4GiB", command.limit));
    limit = *given;
  }
  std::optional<std::chrono::seconds> unusedFor;
  if (command.unusedDays >= 0.0) {
    constexpr double kSecondsOfDay = 86400.0;
    unusedFor = std::chrono::seconds(static_cast<std::int64_t>(command.unusedDays * kSecondsOfDay));
  }
  const PrunedReferences pruned = pruneReferences(limit, unusedFor, command.dryRun);
  print(fmt::format("{} {} references ({}); {} are kept ({})\n", command.dryRun ? "would remove" : "removed",
                    pruned.removed, formatBytes(pruned.removedBytes), pruned.kept,
                    formatBytes(pruned.keptBytes)));
  return kGood;
}

}  // namespace

void addCacheCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand("cache", "lists or removes cached references");
  command->require_subcommand(1);
  auto options = std::make_shared<CacheCommand>();
  auto* listing =
      command->add_subcommand("list", "lists the cached references, the most recently used first");
  listing->add_flag("--json", options->json, "print JSON");
  commands.onChosen(listing, [=] { return list(*options); });

  auto* pruning = command->add_subcommand("prune", "removes the least recently used references");
  auto* limit = pruning->add_option(
      "--limit", options->limit,
      "keep at most this much, such as 500MiB (default: $LUMIVOX_CACHE_LIMIT, else 4GiB)");
  pruning
      ->add_option("--unused-for", options->unusedDays, "also remove references not used for this many days")
      ->check(numberBetween(0.0, 36500.0));
  pruning->add_flag("--all", options->all, "keep nothing")->excludes(limit);
  pruning->add_flag("--dry-run", options->dryRun, "only report what would be removed");
  commands.onChosen(pruning, [=] { return prune(*options); });
}

}  // namespace lumivox::command
