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
  /// The program, or why there is none: for skip().
  static std::optional<std::filesystem::path> program();

  Browser();  ///< std::runtime_error when it does not start
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Loads a file in a window of this size, in pixels, and waits until all of it is there. Forgets what was
  /// seen of the page before.
  void open(const std::filesystem::path& page, int width, int height);
  void resize(int width, int height);
  /// As on a screen or in print ("screen", "print"), of a reader who prefers "light" or "dark".
  void emulate(const std::string& media, const std::string& scheme);
  /// The value of a JavaScript expression; a promise is awaited. std::runtime_error with its message when it
  /// throws.
  nlohmann::json evaluate(const std::string& expression);
  void screenshot(const std::filesystem::path& file);

  /// Errors of scripts, messages to console.error and loads that failed, since open().
  const std::vector<std::string>& errors() const { return errors_; }
  /// Addresses that the page asked for, but for itself and what it holds (data:, blob:), since open().
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
