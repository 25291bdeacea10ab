// How much memory is left: of the machine, of control groups, of the address space.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory_limits.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint64_t kMiB = 1024 * 1024;

/// A machine with 8 GiB of memory available, and its control groups, as files.
class Machine : public TemporaryDirectory {
 public:
  Machine(const std::string& ownGroups, const std::string& mounts) {
    write("proc/meminfo",
          "MemTotal:       16777216 kB\nMemFree:          524288 kB\nMemAvailable:    8388608 kB\n");
    write("proc/self/cgroup", ownGroups);
    write("proc/self/mountinfo", "22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/root rw\n" + mounts);
  }
  void first(const std::string& group, const std::string& limit, std::uint64_t used,
             std::uint64_t cached = 0) const {
    write(group + "/memory.limit_in_bytes", limit + "\n");
    write(group + "/memory.usage_in_bytes", std::to_string(used) + "\n");
    write(group + "/memory.stat",
          "cache 5\ninactive_file 7\ntotal_cache 9\ntotal_inactive_file " + std::to_string(cached) + "\n");
  }
  void second(const std::string& group, const std::string& limit, std::uint64_t used,
              std::uint64_t cached = 0) const {
    write(group + "/memory.max", limit + "\n");
    write(group + "/memory.current", std::to_string(used) + "\n");
    write(group + "/memory.stat", "anon 5\ninactive_file " + std::to_string(cached) + "\n");
  }
  std::uint64_t left() const { return sharedMemoryLeft(path()); }
};

const std::string kSecondMount =
    "30 22 0:26 / /sys/fs/cgroup rw,nosuid,nodev - cgroup2 cgroup2 rw,nsdelegate\n";
const std::string kFirstMount =
    "32 22 0:31 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu,cpuacct\n"
    "35 22 0:32 / /sys/fs/cgroup/memory rw,relatime - cgroup cgroup rw,memory\n"
    "41 22 0:38 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw\n";
const std::string kUnlimited = "9223372036854771712";

}  // namespace

TEST_CASE("without control groups the machine's available memory is left, or no limit known") {
  const Machine machine("", "");
  CHECK(machine.left() == 8192 * kMiB);
  const TemporaryDirectory nothing;
  CHECK(sharedMemoryLeft(nothing.path()) == kNoLimit);
  CHECK(sharedMemoryLeft() > 0);
  CHECK(availableMemory() <= sharedMemoryLeft() + 1024 * kMiB);
}

TEST_CASE("a control group of version 2 leaves its limit less what it holds, without cached files") {
  const Machine machine("0::/lab.slice/run.scope\n", kSecondMount);
  const std::string outer = "sys/fs/cgroup/lab.slice", inner = outer + "/run.scope";
  machine.second(inner, std::to_string(1024 * kMiB), 700 * kMiB, 300 * kMiB);
  CHECK(machine.left() == 624 * kMiB);
  // The least of all groups around it counts, and "max" is no limit.
  machine.second(outer, "max", 9000 * kMiB);
  CHECK(machine.left() == 624 * kMiB);
  machine.second(outer, std::to_string(2048 * kMiB), 2000 * kMiB);
  CHECK(machine.left() == 48 * kMiB);
  machine.second(outer, std::to_string(2048 * kMiB), 3000 * kMiB);
  CHECK(machine.left() == 0);
  machine.second(outer, "max", 0);
  machine.second(inner, std::to_string(64 * 1024 * kMiB), 0);
  CHECK(machine.left() == 8192 * kMiB);
}

TEST_CASE("a control group of version 1 is found by its controller") {
  const Machine machine("9:name=systemd:/\n4:memory:/jobs/17\n1:cpu,cpuacct:/elsewhere\n0::/\n", kFirstMount);
  const std::string mounted = "sys/fs/cgroup/memory";
  machine.first(mounted, kUnlimited, 9000 * kMiB);
  machine.first(mounted + "/jobs", kUnlimited, 9000 * kMiB);
  machine.first(mounted + "/jobs/17", kUnlimited, 9000 * kMiB);
  CHECK(machine.left() == 8192 * kMiB);
  machine.first(mounted + "/jobs", std::to_string(512 * kMiB), 100 * kMiB, 40 * kMiB);
  CHECK(machine.left() == 452 * kMiB);
  machine.first(mounted + "/jobs/17", std::to_string(256 * kMiB), 100 * kMiB, 40 * kMiB);
  CHECK(machine.left() == 196 * kMiB);
}

TEST_CASE("in a container the mounted group is the process's own, whatever path it has outside") {
  const std::string mount = "30 22 0:26 /docker/abc /sys/fs/cgroup ro,nosuid - cgroup2 cgroup rw\n";
  for (const std::string group : {"0::/docker/abc\n", "0::/../../elsewhere\n", "0::/\n"}) {
    INFO(group);
    const Machine machine(group, mount);
    machine.second("sys/fs/cgroup", std::to_string(300 * kMiB), 100 * kMiB);
    CHECK(machine.left() == 200 * kMiB);
  }
  const Machine nested("0::/docker/abc/inner\n", mount);
  nested.second("sys/fs/cgroup", std::to_string(300 * kMiB), 100 * kMiB);
  nested.second("sys/fs/cgroup/inner", std::to_string(60 * kMiB), 20 * kMiB);
  CHECK(nested.left() == 40 * kMiB);
}

TEST_CASE("files of control groups that say nothing sensible limit nothing") {
  const Machine machine("no line of this kind\n0:\n0::/one\n", "30 22\n - cgroup2\n" + kSecondMount);
  CHECK(machine.left() == 8192 * kMiB);
  machine.second("sys/fs/cgroup/one", "many", 5);
  CHECK(machine.left() == 8192 * kMiB);
  machine.write("sys/fs/cgroup/one/memory.max", "1048576\n");
  machine.write("sys/fs/cgroup/one/memory.current", "");
  CHECK(machine.left() == 8192 * kMiB);
}

TEST_CASE("a limit on the address space is what a process can still map") {
#if defined(__SANITIZE_ADDRESS__)
  return skip("the sanitizer needs all of the address space");
#endif
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = 64ull * 1024 * kMiB;
    if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(2);
    const std::uint64_t before = addressSpaceLeft();
    // Taken from it at once, used or not.
    const void* taken = mmap(nullptr, 256 * kMiB, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    const std::uint64_t after = addressSpaceLeft();
    const bool right = taken != MAP_FAILED && before < limit.rlim_cur && before - after >= 256 * kMiB &&
                       before - after < 300 * kMiB && availableMemory() <= after;
    _exit(right ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WIFEXITED(status));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 2) return skip("a lower limit is set already");
  CHECK(WEXITSTATUS(status) == 0);
}
