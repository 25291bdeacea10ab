#include "support/browser.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace lumivox::test {
namespace {

using Json = nlohmann::json;

constexpr int kPatienceMs = 60000;  // a busy machine starts a browser slowly

std::string decodedBase64(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned value = 0, bits = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) break;
    value = (value << 6) | static_cast<unsigned>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>((value >> bits) & 0xffu);
  }
  return bytes;
}

/// Moves a descriptor above 3 and 4, which the browser uses for its pipe.
int movedUp(int descriptor) {
  const int moved = fcntl(descriptor, F_DUPFD_CLOEXEC, 10);
  close(descriptor);
  return moved;
}

}  // namespace

std::optional<std::filesystem::path> Browser::program() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
      if (const auto file = std::filesystem::path(folder) / name; access(file.c_str(), X_OK) == 0)
        return file;
  return std::nullopt;
}

Browser::Browser() {
  const auto found = program();
  if (!found) throw std::runtime_error("no chromium on the path");
  int to[2], from[2];
  if (pipe(to) != 0 || pipe(from) != 0) throw std::runtime_error("no pipe for the browser");
  for (int* end : {&to[0], &to[1], &from[0], &from[1]}) *end = movedUp(*end);
  const std::string profile = "--user-data-dir=" + profile_.path().string();
  signal(SIGPIPE, SIG_IGN);  // read and write report a browser that died
  process_ = fork();
  if (process_ < 0) throw std::runtime_error("the browser could not be started");
  if (process_ == 0) {
    setpgid(0, 0);  // a group of its own, to end its child processes too
    dup2(to[0], 3);
    dup2(from[1], 4);
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (const int standard : {0, 1, 2}) dup2(nowhere, standard);
    execl(found->c_str(), "chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
          "--disable-background-networking", "--disable-component-update", "--disable-dev-shm-usage",
          "--host-resolver-rules=MAP * ~NOTFOUND", "--remote-debugging-pipe", profile.c_str(), "about:blank",
          nullptr);
    _exit(127);
  }
  close(to[0]);
  close(from[1]);
  to_ = to[1];
  from_ = from[0];
  const Json target = call("Target.createTarget", {{"url", "about:blank"}});
  session_ =
      call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}}).at("sessionId");
  for (const char* part : {"Page.enable", "Runtime.enable", "Log.enable", "Network.enable"})
    call(part, Json::object());
  call("Network.emulateNetworkConditions",
       {{"offline", true}, {"latency", 0}, {"downloadThroughput", 0}, {"uploadThroughput", 0}});
}

Browser::~Browser() {
  if (to_ >= 0) close(to_);
  if (from_ >= 0) close(from_);
  if (process_ <= 0) return;
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

Json Browser::receive() {
  for (;;) {
    if (const std::size_t end = buffer_.find('\0'); end != std::string::npos) {
      Json message = Json::parse(buffer_.substr(0, end));
      buffer_.erase(0, end + 1);
      return message;
    }
    pollfd waiting{from_, POLLIN, 0};
    if (poll(&waiting, 1, kPatienceMs) <= 0) throw std::runtime_error("the browser does not answer");
    char bytes[65536];
    const ssize_t count = read(from_, bytes, sizeof bytes);
    if (count <= 0) throw std::runtime_error("the browser has ended");
    buffer_.append(bytes, static_cast<std::size_t>(count));
  }
}

Json Browser::call(const std::string& method, const Json& parameters) {
  Json message = {{"id", ++lastCall_}, {"method", method}, {"params", parameters}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump() + '\0';
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t count = write(to_, text.data() + written, text.size() - written);
    if (count <= 0) throw std::runtime_error("the browser has ended");
    written += static_cast<std::size_t>(count);
  }
  for (;;) {
    const Json answer = receive();
    if (!answer.contains("id")) {
      note(answer);
    } else if (answer.at("id") == lastCall_) {
      if (answer.contains("error")) throw std::runtime_error(method + ": " + answer.at("error").dump());
      return answer.value("result", Json::object());
    }
  }
}

void Browser::note(const Json& event) {
  const std::string method = event.value("method", "");
  const Json parameters = event.value("params", Json::object());
  if (method == "Page.loadEventFired") {
    loaded_ = true;
  } else if (method == "Runtime.exceptionThrown") {
    const Json& details = parameters.at("exceptionDetails");
    errors_.push_back(details.contains("exception")
                          ? details.at("exception").value("description", details.value("text", ""))
                          : details.value("text", ""));
  } else if (method == "Runtime.consoleAPICalled") {
    const std::string type = parameters.value("type", "");
    if (type == "error" || type == "assert")
      errors_.push_back("console." + type + ": " + parameters.at("args").dump());
  } else if (method == "Log.entryAdded") {
    const Json& entry = parameters.at("entry");
    if (entry.value("level", "") == "error")
      errors_.push_back(entry.value("text", "") + " " + entry.value("url", ""));
  } else if (method == "Network.requestWillBeSent") {
    const std::string url = parameters.at("request").value("url", "");
    if (url != page_ && url.rfind("data:", 0) != 0 && url.rfind("blob:", 0) != 0) requests_.push_back(url);
  }
}

void Browser::resize(int width, int height) {
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
}

void Browser::emulate(const std::string& media, const std::string& scheme) {
  const Json preferred = {{"name", "prefers-color-scheme"}, {"value", scheme}};
  call("Emulation.setEmulatedMedia", {{"media", media}, {"features", Json::array({preferred})}});
}

void Browser::open(const std::filesystem::path& page, int width, int height) {
  page_ = "file://" + std::filesystem::absolute(page).string();
  resize(width, height);
  call("Page.navigate", {{"url", "about:blank"}});
  errors_.clear();
  requests_.clear();
  loaded_ = false;
  const Json answer = call("Page.navigate", {{"url", page_}});
  if (answer.contains("errorText"))
    throw std::runtime_error(page_ + ": " + answer.at("errorText").get<std::string>());
  while (!loaded_) note(receive());
}

Json Browser::evaluate(const std::string& expression) {
  const Json answer = call(
      "Runtime.evaluate",
      {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}, {"userGesture", true}});
  if (answer.contains("exceptionDetails")) throw std::runtime_error(answer.at("exceptionDetails").dump());
  return answer.at("result").value("value", Json());
}

void Browser::screenshot(const std::filesystem::path& file) {
  const Json answer = call("Page.captureScreenshot", {{"format", "png"}, {"captureBeyondViewport", true}});
  std::ofstream(file, std::ios::binary) << decodedBase64(answer.at("data").get<std::string>());
}

}  // namespace lumivox::test
