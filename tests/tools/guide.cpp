#include "tools/guide.h"

#include <algorithm>
#include <regex>
#include <sstream>

#include "lumivox/base/file.h"
#include "lumivox/base/image.h"

namespace fs = std::filesystem;

namespace lumivox::test {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t"), to = text.find_last_not_of(" \t");
  return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

bool matches(const std::string& text, const char* pattern) {
  return std::regex_search(text, std::regex(pattern));
}

/// Whether a regular expression is found in a text whose lines begin and end with ^ and $.
bool isFound(const std::string& pattern, const std::string& text) {
  return std::regex_search(text, std::regex(pattern, std::regex::ECMAScript | std::regex::multiline));
}

std::vector<std::string> splitAt(const std::string& text, const std::string& between) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t to = 0; to != std::string::npos; from = to + between.size())
    parts.push_back(text.substr(from, (to = text.find(between, from)) - from));
  return parts;
}

std::string lastLine(const std::string& text) {
  const std::string lines = text.substr(0, text.find_last_not_of('\n') + 1);
  return lines.substr(lines.rfind('\n') + 1);
}

bool isWritten(const fs::path& file) {
  return fs::exists(file) && !fs::is_empty(file);
}

/// Whether a mark holds; `exits` apart.
bool holds(const Mark& mark, const CommandResult& result, const fs::path& folder) {
  const std::string all = result.output + result.errors;
  const auto each = [](const std::string& list, const char* between, const auto& check) {
    const std::vector<std::string> parts = splitAt(list, between);
    return std::all_of(parts.begin(), parts.end(), check);
  };
  if (mark.verb == "prints")
    return each(mark.what, " ; ", [&](const std::string& one) { return isFound(one, all); });
  if (mark.verb == "lacks")
    return each(mark.what, " ; ", [&](const std::string& one) { return !isFound(one, all); });
  if (mark.verb == "ends with") return isFound(mark.what, lastLine(result.output));
  if (mark.verb == "writes")
    return each(mark.what, " ", [&](const std::string& one) { return isWritten(folder / one); });
  if (mark.verb == "writes no")
    return each(mark.what, " ", [&](const std::string& one) { return !fs::exists(folder / one); });
  const std::size_t blank = mark.what.find(' ');  // layers
  const fs::path file = folder / mark.what.substr(0, blank);
  if (!isWritten(file)) return false;
  const LayeredImage image = readExr(file);
  return each(mark.what.substr(blank + 1), " ",
              [&](const std::string& one) { return image.layers.count(one) == 1; });
}

/// All of the tree but what is built, written or kept by version control.
void copyTree(const fs::path& from, const fs::path& to) {
  fs::create_directories(to);
  for (const auto& entry : fs::directory_iterator(from)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("build", 0) == 0 || name == "out" || name == ".git" || name == ".cache") continue;
    fs::copy(entry.path(), to / name, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  }
}

}  // namespace

std::vector<Quote> quotesOf(const std::string& markdown) {
  std::vector<Quote> quotes;
  std::istringstream stream(markdown);
  bool inside = false;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.rfind("```", 0) == 0) {
      inside = !inside;
      if (inside) quotes.push_back({line.substr(3), "", number});
    } else if (inside) {
      quotes.back().text += line + '\n';
    }
  }
  return quotes;
}

std::vector<fs::path> guides() {
  const fs::path root = sourceDirectory();
  std::vector<fs::path> files = {root / "README.md", root / "CONTRIBUTING.md", root / "CHANGELOG.md"};
  for (const auto& entry : fs::directory_iterator(root / "docs"))
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  for (const char* folder : {"cmake", "framework", "laboratory", "scenes", "shaders", "tests", "tools"})
    if (fs::exists(root / folder))
      for (const auto& entry : fs::recursive_directory_iterator(root / folder))
        if (entry.path().filename() == "README.md") files.push_back(entry.path());
  for (const char* folder : {"techniques", "templates"}) files.push_back(root / folder / "README.md");
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> commandLinesOf(const std::string& markdown) {
  std::vector<std::string> commands;
  for (const Quote& quote : quotesOf(markdown)) {
    if (quote.language != "sh") continue;
    std::istringstream lines(quote.text);
    for (std::string line; std::getline(lines, line);) {
      // A comment begins behind a blank: '####' in a file's name is none.
      if (const std::size_t comment = line.find(" #"); comment != std::string::npos) line.erase(comment);
      if (!trimmed(line).empty()) commands.push_back(trimmed(line));
    }
  }
  return commands;
}

std::vector<NamedCommand> namedCommandsOf(const std::string& markdown) {
  static const std::regex code("`(?:\\./run |lumivox |(?=vdbexport ))([^`]+)`");
  std::vector<NamedCommand> commands;
  for (std::sregex_iterator match(markdown.begin(), markdown.end(), code), end; match != end; ++match) {
    std::istringstream words((*match)[1].str());
    NamedCommand named{"lumivox", "", {}};
    std::string word;
    words >> word;
    if (word == "vdbexport")
      named.program = word;
    else if (word[0] == '-')
      named.options.push_back(word);
    else
      named.command = word;
    if (std::any_of(word.begin(), word.end(), [](unsigned char c) { return std::isupper(c) != 0; })) continue;
    while (words >> word)
      if (word.rfind("--", 0) == 0 && word.size() > 2)
        named.options.push_back(word.substr(0, word.find_first_of("=,.")));
    commands.push_back(std::move(named));
  }
  return commands;
}

const std::vector<Omission>& omissions() {
  static const std::vector<Omission> list = {
      {"^tests/fuzz/nightly", "", "builds everything anew with a fuzzer and runs for minutes"},
      {"^\\./run reproduce --repeats 9", "", "measures for hours, and writes the project's own figures"},
      {"^build/bin/bench_cone_stores --write", "",
       "measures for minutes, and writes the project's own figures"},
      {"^lumivox stress (-o|voxel)", "", "a battery takes minutes; stress_tests run its quick part"},
      {"^lumivox stress --from", "", "shows what the command before it would have stored"},
      {"\\(cd build && cpack", "", "writes into build/; sdk_test packs in a folder of its own"},
      {"scenes/bunny\\.scene", "lumivox check scenes/bunny.scene", "the Stanford bunny is not in the tree"},
      {"\\bdragon\\b", "lumivox check scenes/dragon.scene", "the Stanford dragon is not in the tree"},
      {"^chromium ", "command -v chromium", "a browser need not be installed"},
      {"--slurm", "", "submits to a cluster; cli_cluster_test starts one of its own"},
      {"^srun ", "", "runs on a node of a cluster that the reader has"},
      {"^(ssh|for host in) ", "", "reaches machines that only the reader has"},
      {"results merge --store out/results.sqlite out/one.sqlite", "",
       "merges what the machines before it would have measured"},
      {"^parallel ", "", "GNU parallel need not be installed; cli_cluster_test runs shares"},
      {"^vdb_print", "command -v vdb_print", "OpenVDB's own tools need not be installed"},
  };
  return list;
}

const std::vector<Reduction>& reductions() {
  static const std::vector<Reduction> list = {
      {"^\\./run$", "./run report scenes/cornell.scene"},
      {"^(?!.* --resolution )(.*?\\b(?:render|reference|explain)) (\\S*scenes/|docs/examples/)",
       "$1 --resolution 32x32 $2"},
      {"--spp (64|1024)", "--spp 16"},
      // Texts of sweeps name scenes and pipelines; what they would measure is planned.
      {"\\bsweep (\\S+\\.sweep)", "sweep --plan --no-sweep $1"},
      {"\\b(report|sweep|tune) (\\S*scenes/|docs/examples/)",
       "$1 --resolution 24x24 --spp 8 --subpixels 1 --repeats 3 --seeds 2 --flicker-frames 0 --no-sweep $2"},
      // All committed pipelines take half an hour; two of them show the same.
      {"^(?!.*(--pipeline|\\.sweep))((?:\\./run|lumivox) (?:report|sweep|tune) .*)$",
       "$2 --pipeline scenes/pipelines/direct_lighting.pipeline --pipeline "
       "scenes/pipelines/reflective_shadow_maps.pipeline"},
      {"\\btune ", "tune --evaluations 3 "},
      {"\\breproduce (gomes2015-\\S+)", "reproduce --scale 0.1 --repeats 1 $1"},
      {"--resolution 64,128,256", "--resolution 8,16 --repeats 1"},
      // Root has no sandbox; the project's own image stays.
      {"chromium --headless (.*)=docs/images/", "chromium --headless --no-sandbox --disable-gpu $1=out/"},
      {"stress --quick",
       "stress --quick --case image_1x1 --pipeline "
       "scenes/pipelines/direct_lighting.pipeline"},
      {"--set resolution=160", "--set resolution=32"},
      {"--set resolution=128", "--set resolution=64"},
  };
  return list;
}

std::string reduced(std::string command) {
  for (const Reduction& reduction : reductions())
    command = std::regex_replace(command, std::regex(reduction.pattern), reduction.by);
  return command;
}

std::vector<Step> stepsOf(const std::string& markdown) {
  static const std::regex mark("<!-- checked(?: \\[(.*?)\\])?: (.*?) -->"),
      verbs("(runs|prints|lacks|ends with|exits|writes no|writes|layers) (.+)");
  std::vector<Step> steps;
  std::istringstream stream(markdown);
  std::string language;
  bool inside = false;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.rfind("```", 0) == 0) {
      inside = !inside;
      language = line.substr(3);
    } else if (inside) {
      if (language != "sh") continue;
      for (std::string& command : commandLinesOf("```sh\n" + line + "\n```\n"))
        steps.push_back({number, std::move(command), {}, false, {}});
    } else {
      for (std::sregex_iterator one(line.begin(), line.end(), mark), end; one != end; ++one) {
        const std::string part = (*one)[1], all = (*one)[2];
        INFO("line " << number << ": " << one->str());
        std::smatch words;
        REQUIRE(std::regex_match(all, words, verbs));
        if (words[1] == "runs") {
          steps.push_back({number, words[2], {}, false, {}});
          continue;
        }
        const auto about = std::find_if(steps.rbegin(), steps.rend(), [&](const Step& step) {
          return step.command.find(part) != std::string::npos;
        });
        REQUIRE(about != steps.rend());
        about->marks.push_back({number, words[1], words[2]});
      }
    }
  }
  return steps;
}

std::string unheld(const Step& step, const fs::path& folder) {
  if (step.omitted) return "";
  const std::string said = step.result.output + step.result.errors;
  std::string all;
  int expected = 0;
  for (const Mark& mark : step.marks)
    if (mark.verb == "exits") {
      const std::vector<std::string> parts = splitAt(mark.what, " if it prints ");
      if (parts.size() == 1 || isFound(parts[1], said)) expected = std::stoi(parts[0]);
    } else if (!holds(mark, step.result, folder)) {
      all += std::to_string(mark.line) + ": not so: " + mark.verb + " " + mark.what + "\n";
    }
  if (step.result.exitCode != expected)
    all += std::to_string(step.line) + ": exit code " + std::to_string(step.result.exitCode) +
           " in place of " + std::to_string(expected) + "\n";
  return all;
}

FollowedGuide::FollowedGuide(const std::string& name)
    : name_(name),
      path_((home_.path() / "stand_ins").string()),
      steps_(stepsOf(readFile(sourceDirectory() / name))) {
  copyTree(sourceDirectory(), folder());
  // As after the set-up: configured, packages found, programs built.
  fs::create_directories(folder() / "build");
  fs::create_symlink(binaryDirectory() / "bin", folder() / "build/bin");
  fs::copy(folder() / "cmake/packages.txt", folder() / "build/.packages-ok");
  writeFileAtomically(folder() / "build/build.ninja", "");
  for (const char* tool : {"ninja", "cmake", "ctest"}) {
    const fs::path file =
        home_.write(std::string("stand_ins/") + tool, "#!/bin/sh\necho " + std::string(tool) + " \"$@\"\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  path_ += ":" + (folder() / "build/bin").string();
  run("command -v git && git init -q . && git add -A");
  follow();
}

FollowedGuide::FollowedGuide(const std::string& name,
                             const std::vector<std::pair<std::string, std::string>>& words,
                             const std::vector<fs::path>& programs)
    : name_(name), steps_(stepsOf(readFile(sourceDirectory() / name))) {
  for (const fs::path& program : programs) path_ += (path_.empty() ? "" : ":") + program.string();
  fs::create_directories(folder());
  const auto replace = [&](std::string& text) {
    for (const auto& [word, by] : words)
      for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + by.size()))
        text.replace(at, word.size(), by);
  };
  for (Step& step : steps_) {
    replace(step.command);
    for (Mark& mark : step.marks) replace(mark.what);
  }
  follow();
}

std::string FollowedGuide::environment() const {
  const std::string home = home_.path().string();
  return "cd '" + folder().string() + "'\nunset LUMIVOX_ASSETS LUMIVOX_TECHNIQUES LUMIVOX_RESULTS COLUMNS\n" +
         "export HOME='" + home + "/home' LUMIVOX_CACHE='" + home + "/cache'\nmkdir -p \"$HOME\"\n" +
         "export PATH='" + path_ + "':\"$PATH\"\n";
}

void FollowedGuide::follow() {
  const auto output = [&](std::size_t i, const char* kind) {
    return home_.path() / ("said_" + std::to_string(i) + "." + kind);
  };
  std::string script = environment();
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    Step& step = steps_[i];
    const auto omission = std::find_if(omissions().begin(), omissions().end(), [&](const Omission& one) {
      return matches(step.command, one.pattern);
    });
    step.omitted =
        omission != omissions().end() && (omission->needs[0] == '\0' || run(omission->needs).exitCode != 0);
    if (step.omitted) continue;
    // In the shell itself, so that `cd` and `export` hold for what follows.
    script += "{ " + reduced(step.command) + "\n} >'" + output(i, "out").string() + "' 2>'" +
              output(i, "err").string() + "' </dev/null; echo $? >'" + output(i, "code").string() + "'\n";
  }
  const fs::path file = home_.write("follow.sh", script);
  const CommandResult shell = runCommand("bash '" + file.string() + "'");
  INFO(shell.errors);
  REQUIRE(shell.exitCode == 0);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (steps_[i].omitted) continue;
    INFO(steps_[i].command);
    REQUIRE(fs::exists(output(i, "code")));
    steps_[i].result = {std::stoi(readFile(output(i, "code"))), readFile(output(i, "out")),
                        readFile(output(i, "err"))};
  }
}

const CommandResult& FollowedGuide::of(const std::string& part) const {
  INFO(part);
  const auto found = std::find_if(steps_.rbegin(), steps_.rend(), [&](const Step& step) {
    return !step.omitted && step.command.find(part) != std::string::npos;
  });
  REQUIRE(found != steps_.rend());
  return found->result;
}

CommandResult FollowedGuide::run(const std::string& command) const {
  return runCommand(environment() + command);
}

bool FollowedGuide::has(const std::string& name) const {
  return fs::exists(file(name));
}

std::size_t FollowedGuide::omitted() const {
  return static_cast<std::size_t>(
      std::count_if(steps_.begin(), steps_.end(), [](const Step& step) { return step.omitted; }));
}

std::string FollowedGuide::failures() const {
  std::string all;
  for (const Step& step : steps_)
    if (const std::string bad = unheld(step, folder()); !bad.empty()) {
      for (const std::string& one : splitAt(bad.substr(0, bad.size() - 1), "\n"))
        all += name_ + ":" + one + "\n";
      all += step.command + "\n" + step.result.output + step.result.errors + "\n";
    }
  return all;
}

std::string FollowedGuide::leftovers() const {
  return run("command -v git >/dev/null && { git diff --name-only; git ls-files --others --exclude-standard; }")
      .output;
}

}  // namespace lumivox::test
