// A headless Chromium that a test drives through its debugging pipe (Chrome DevTools Protocol). It reaches no
// network.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "support/support.h"

namespace lumivox::test {

class Browser {
 public:
  /// The browser's program; nothing if it is not installed.
  static std::optional<std::filesystem::path> program();

  Browser();  ///< throws std::runtime_error if it does not start
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Loads a file in a window of this size, in pixels, and waits until it is complete. Clears errors() and
  /// requests().
  void open(const std::filesystem::path& page, int width, int height);
  void resize(int width, int height);
  /// Emulates the media type ("screen", "print") and the preferred colour scheme ("light", "dark").
  void emulate(const std::string& media, const std::string& scheme);
  /// The value of a JavaScript expression; a promise is awaited. Throws std::runtime_error with the message
  /// of its exception.
  nlohmann::json evaluate(const std::string& expression);
  void screenshot(const std::filesystem::path& file);

  /// Errors of scripts, messages to console.error and loads that failed, since open().
  const std::vector<std::string>& errors() const { return errors_; }
  /// Addresses that the page requested since open(), except itself and embedded data (data:, blob:).
  const std::vector<std::string>& requests() const { return requests_; }

 private:
  nlohmann::json call(const std::string& method, const nlohmann::json& parameters);
  nlohmann::json receive();
  void note(const nlohmann::json& event);

  TemporaryDirectory profile_;
  int process_ = -1, to_ = -1, from_ = -1;
  int lastCall_ = 0;
  bool loaded_ = false;
  std::string session_, page_, buffer_;
  std::vector<std::string> errors_, requests_;
};

}  // namespace lumivox::test
