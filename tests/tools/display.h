// A display of the test's own, which no one sees, and what stands on it.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "support/support.h"

namespace lumivox::test {

/// Xvfb, which finds itself a free number and says when it is ready: no two tests can take the same one, as
/// they can with xvfb-run, which looks for a lock file and then starts. It ends with this process. While it
/// lives, DISPLAY and XAUTHORITY lead there.
class Display {
 public:
  static constexpr int kWidth = 1400, kHeight = 1000;

  Display() {
    // One cookie for a display of any number: family, address, number, name and data, each with its length.
    std::string cookie("\xff\xff\0\0\0\0\0\x12MIT-MAGIC-COOKIE-1\0\x10", 28);
    std::random_device random;
    for (int i = 0; i < 16; ++i) cookie += static_cast<char>(random() & 0xffu);
    folder_.write("authority", cookie);
    int ready[2];
    if (pipe(ready) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);
      constexpr int kNumberTo = 3;
      const int nowhere = open("/dev/null", O_RDWR);
      for (const int descriptor : {0, 1, 2}) dup2(nowhere, descriptor);
      dup2(ready[1], kNumberTo);
      const std::string authority = (folder_.path() / "authority").string(),
                        screen = std::to_string(kWidth) + "x" + std::to_string(kHeight) + "x24";
      execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", screen.c_str(), "-nolisten", "tcp",
             "-noreset", "-auth", authority.c_str(), "-fbdir", folder_.path().c_str(),
             static_cast<char*>(nullptr));
      _exit(127);
    }
    close(ready[1]);
    std::string number;
    for (char c = 0; read(ready[0], &c, 1) == 1 && c != '\n';) number += c;
    close(ready[0]);
    if (number.empty()) return;
    there_ = true;
    number_ = ":" + number;
  }
  ~Display() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// Programs that are started from now on show their windows there.
  void announce() const {
    if (!there_) return;
    setenv("DISPLAY", number_.c_str(), 1);
    setenv("XAUTHORITY", (folder_.path() / "authority").c_str(), 1);
  }
  /// Whether there is one: Xvfb may not be installed.
  bool there() const { return there_; }
  /// What stands on the screen now, from its memory: a file of xwd, with big-endian words before pixels of
  /// blue, green, red and nothing.
  ImageBuffer seen() const {
    const std::string bytes = readFile(folder_.path() / "Xvfb_screen0");
    const auto word = [&](std::size_t index) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i)
        value = value << 8 | static_cast<unsigned char>(bytes.at(4 * index + i));
      return static_cast<std::size_t>(value);
    };
    constexpr std::size_t kHeader = 0, kBytesPerLine = 12, kColours = 19, kColourBytes = 12;
    const std::size_t first = word(kHeader) + kColourBytes * word(kColours);
    ImageBuffer image(kWidth, kHeight, 3);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < 3; ++c)
          image.at(x, y, c) = static_cast<float>(static_cast<unsigned char>(bytes.at(
                                  first + word(kBytesPerLine) * static_cast<std::size_t>(y) +
                                  4 * static_cast<std::size_t>(x) + 2 - static_cast<std::size_t>(c)))) /
                              255.0f;
    return image;
  }

 private:
  TemporaryDirectory folder_;
  pid_t pid_ = -1;
  bool there_ = false;
  std::string number_;
};

/// That of this test program, from the first test on that asks for it.
inline const Display& display() {
  static const Display one;
  one.announce();  // what a case sets is put back after it
  return one;
}

}  // namespace lumivox::test
