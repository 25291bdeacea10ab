#include "common/outputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

/// The endings of all kinds of file that the programs read and write.
constexpr const char* kEndings[] = {
    ".exr",          ".png",  ".jpg",  ".jpeg",  ".tga",   ".svg",      ".mp4",   ".html",
    ".md",           ".csv",  ".json", ".vdb",   ".scene", ".pipeline", ".sweep", ".view",
    ".reproduction", ".obj",  ".mtl",  ".gz",    ".so",    ".txt",      ".db",    ".sqlite",
    ".sqlite3",      ".glsl", ".comp", ".blend", ".log",   ".xml",      ".dot",   ".gv"};

/// Whether both names lead to the same existing regular file. Devices such as /dev/null do not count: they
/// keep nothing.
bool isOneFile(const fs::path& one, const fs::path& other) {
  std::error_code failure;
  return fs::is_regular_file(one, failure) && fs::equivalent(one, other, failure);
}

/// The same, also for files that do not exist yet.
bool willBeOneFile(const fs::path& one, const fs::path& other) {
  std::error_code failure;
  if (fs::exists(one, failure) || fs::exists(other, failure)) return isOneFile(one, other);
  // weakly_canonical() needs an existing beginning of the path, which a file name alone does not have.
  const fs::path first = fs::weakly_canonical(fs::absolute(one, failure), failure),
                 second = fs::weakly_canonical(fs::absolute(other, failure), failure);
  return !first.empty() && first == second;
}

}  // namespace

Outputs& Outputs::add(std::string option, fs::path file, std::vector<std::string> endings,
                      Endings strictness) {
  if (!file.empty()) outputs_.push_back({std::move(option), std::move(file), std::move(endings), strictness});
  return *this;
}

void Outputs::checkEnding(const Output& output) {
  const std::string ending = output.file.extension().string();
  const auto has = [&](const auto& all) {
    return std::find(std::begin(all), std::end(all), ending) != std::end(all);
  };
  if (has(output.endings) || (output.strictness == Endings::otherKindsRefused && !has(kEndings))) return;
  throw Error(fmt::format("{} '{}': expected a name that ends in {}", output.option, output.file.string(),
                          fmt::join(output.endings, " or ")));
}

void Outputs::check(const std::vector<fs::path>& inputs) const {
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const Output& output = outputs_[i];
    checkEnding(output);
    for (const fs::path& input : inputs)
      if (!input.empty() && willBeOneFile(output.file, input))
        throw Error(fmt::format("{} '{}': that is the file '{}', which is read; expected another name",
                                output.option, output.file.string(), input.string()));
    requireWritable(output.file);
    for (std::size_t other = 0; other < i; ++other)
      if (willBeOneFile(output.file, outputs_[other].file))
        throw Error(fmt::format("{} '{}': that is the file of {} too; expected two names", output.option,
                                output.file.string(), outputs_[other].option));
  }
}

void Outputs::requireUnread() const {
  for (const Output& output : outputs_) requireUnread(output.option, output.file);
}

void Outputs::requireUnread(const std::string& option, const fs::path& file) {
  if (wasRead(file))
    throw Error(fmt::format("{} '{}': that file was read for the same work; expected another name", option,
                            file.string()));
}

}  // namespace lumivox::command
