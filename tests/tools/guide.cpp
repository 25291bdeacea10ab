#include "tools/guide.h"

#include <algorithm>
#include <regex>
#include <sstream>

#include "lumivox/base/file.h"

namespace fs = std::filesystem;

namespace lumivox::test {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t from = text.find_first_not_of(" \t"), to = text.find_last_not_of(" \t");
  return from == std::string::npos ? "" : text.substr(from, to - from + 1);
}

/// Line breaks and indentation are layout.
std::string onOneLine(const std::string& text) {
  static const std::regex blanks("\\s+");
  return std::regex_replace(text, blanks, " ");
}

bool matches(const std::string& text, const char* pattern) {
  return std::regex_search(text, std::regex(pattern));
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
      {"scenes/dragon\\.scene", "lumivox check scenes/dragon.scene",
       "the Stanford dragon is not in the tree"},
      {"^chromium ", "command -v chromium", "a browser need not be installed"},
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

FollowedGuide::FollowedGuide(const std::string& name)
    : text_(readFile(sourceDirectory() / name)), path_((home_.path() / "stand_ins").string()) {
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
  follow(commandLinesOf(text_));
}

FollowedGuide::FollowedGuide(const std::string& name,
                             const std::vector<std::pair<std::string, std::string>>& words,
                             const std::vector<fs::path>& programs)
    : text_(readFile(sourceDirectory() / name)) {
  for (const fs::path& program : programs) path_ += (path_.empty() ? "" : ":") + program.string();
  fs::create_directories(folder());
  std::vector<std::string> commands = commandLinesOf(text_);
  for (std::string& command : commands) {
    for (const auto& [word, by] : words)
      for (std::size_t at = command.find(word); at != std::string::npos;
           at = command.find(word, at + by.size()))
        command.replace(at, word.size(), by);
  }
  follow(commands);
}

std::string FollowedGuide::environment() const {
  const std::string home = home_.path().string();
  return "cd '" + folder().string() + "'\nunset LUMIVOX_ASSETS LUMIVOX_TECHNIQUES LUMIVOX_RESULTS COLUMNS\n" +
         "export HOME='" + home + "/home' LUMIVOX_CACHE='" + home + "/cache'\nmkdir -p \"$HOME\"\n" +
         "export PATH='" + path_ + "':\"$PATH\"\n";
}

void FollowedGuide::follow(const std::vector<std::string>& commands) {
  const auto output = [&](std::size_t i, const char* kind) {
    return home_.path() / ("said_" + std::to_string(i) + "." + kind);
  };
  std::string script = environment();
  for (const std::string& command : commands) {
    const auto omission = std::find_if(omissions().begin(), omissions().end(),
                                       [&](const Omission& one) { return matches(command, one.pattern); });
    if (omission != omissions().end() && (omission->needs[0] == '\0' || run(omission->needs).exitCode != 0)) {
      ++omitted_;
      continue;
    }
    const std::size_t i = commands_.size();
    commands_.push_back({command, {}});
    // In the shell itself, so that `cd` and `export` hold for what follows.
    script += "{ " + reduced(command) + "\n} >'" + output(i, "out").string() + "' 2>'" +
              output(i, "err").string() + "' </dev/null; echo $? >'" + output(i, "code").string() + "'\n";
  }
  const fs::path file = home_.write("follow.sh", script);
  const CommandResult shell = runCommand("bash '" + file.string() + "'");
  INFO(shell.errors);
  REQUIRE(shell.exitCode == 0);
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    INFO(commands_[i].command);
    REQUIRE(fs::exists(output(i, "code")));
    commands_[i].result = {std::stoi(readFile(output(i, "code"))), readFile(output(i, "out")),
                           readFile(output(i, "err"))};
  }
}

const CommandResult& FollowedGuide::of(const std::string& part) const {
  const auto has = [&](const Followed& one) { return one.command.find(part) != std::string::npos; };
  INFO(part);
  const auto found = std::find_if(commands_.rbegin(), commands_.rend(), has);
  REQUIRE(found != commands_.rend());
  return found->result;
}

CommandResult FollowedGuide::run(const std::string& command) const {
  return runCommand(environment() + command);
}

bool FollowedGuide::says(const std::string& sentence) const {
  return onOneLine(text_).find(onOneLine(sentence)) != std::string::npos;
}

bool FollowedGuide::has(const std::string& name) const {
  return fs::exists(file(name));
}

std::string FollowedGuide::failures(const std::vector<std::string>& expected) const {
  std::string all;
  for (const Followed& one : commands_) {
    const bool mayFail = std::any_of(expected.begin(), expected.end(), [&](const std::string& part) {
      return one.command.find(part) != std::string::npos;
    });
    if (one.result.exitCode != 0 && !mayFail)
      all += one.command + "\n" + one.result.output + one.result.errors + "\n";
  }
  return all;
}

std::string FollowedGuide::leftovers() const {
  return run("command -v git >/dev/null && { git diff --name-only; git ls-files --others --exclude-standard; }")
      .output;
}

}  // namespace lumivox::test
