// A Slurm cluster of one node in a folder: munged, slurmctld and slurmd of this test alone, on ports that
// were free, without accounting. Each ends with this process.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "lumivox/base/start_process.h"
#include "tools/started.h"

namespace lumivox::test {

class Cluster {
 public:
  /// Why there is none here; empty: it is up.
  std::string whyNot;

  explicit Cluster(const std::filesystem::path& folder) : folder_(folder) {
    for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch", "squeue"})
      if (programFor(program).empty()) {
        whyNot = std::string(program) + " is not installed (Debian: apt-get install slurm-wlm munge)";
        return;
      }
    for (const char* part : {"state", "spool", "run"}) std::filesystem::create_directories(folder_ / part);
    // munged wants a key that nobody else reads.
    writeFileAtomically(folder_ / "munge.key", std::string(1024, 'k'));
    std::filesystem::permissions(folder_ / "munge.key", std::filesystem::perms::owner_read);
    writeFileAtomically(folder_ / "slurm.conf", configuration());
    const std::string conf = (folder_ / "slurm.conf").string();
    setenv("SLURM_CONF", conf.c_str(), 1);
    start({"munged", "--foreground", "--force", "--socket=" + file("run/munge"),
           "--key-file=" + file("munge.key"), "--log-file=" + file("munged.log"),
           "--pid-file=" + file("run/munged.pid"), "--seed-file=" + file("munge.seed"), "--num-threads=2"});
    if (!becomes([&] { return std::filesystem::exists(folder_ / "run/munge"); })) {
      whyNot = "munged does not come up in a folder";
      return;
    }
    start({"slurmctld", "-D", "-f", conf});
    start({"slurmd", "-D", "-N", "localhost", "-f", conf});
    const bool up =
        becomes([&] { return contains(runCommand("sinfo --noheader --format=%T 2>&1").output, "idle"); });
    if (!up) whyNot = "slurmd does not come up here: " + runCommand("tail -3 " + file("slurmd.log")).output;
  }
  ~Cluster() {
    // Jobs outlive the daemons that started them.
    if (whyNot.empty()) {
      runCommand("scancel --signal=KILL --full --user=$(id -un) 2>&1; scancel --user=$(id -un) 2>&1");
      becomes([] { return runCommand("squeue --noheader").output.empty(); });
    }
    for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
      kill(*process, SIGTERM);
      for (int i = 0; i < 100 && waitpid(*process, nullptr, WNOHANG) == 0; ++i) usleep(50'000);
      kill(*process, SIGKILL);
      waitpid(*process, nullptr, 0);
    }
    unsetenv("SLURM_CONF");
  }
  Cluster(const Cluster&) = delete;
  Cluster& operator=(const Cluster&) = delete;

 private:
  static std::string programFor(const std::string& name) {
    const std::string found = runCommand("PATH=\"$PATH:/usr/sbin:/sbin\" command -v " + name).output;
    return found.substr(0, found.find('\n'));
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  void start(std::vector<std::string> words) {
    words.front() = programFor(words.front());
    ProcessStart program;
    program.words = words;
    program.ownGroup = true;
    processes_.push_back(startProcess(program));
  }
  /// A port that nobody listens on now.
  static int freePort() {
    const int handle = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    bind(handle, reinterpret_cast<sockaddr*>(&address), size);
    getsockname(handle, reinterpret_cast<sockaddr*>(&address), &size);
    close(handle);
    return ntohs(address.sin_port);
  }
  std::string configuration() const {
    utsname system{};
    uname(&system);
    const passwd* user = getpwuid(geteuid());
    const std::string name = user == nullptr ? std::to_string(geteuid()) : user->pw_name;
    return "ClusterName=lumivox\nSlurmctldHost=localhost\nSlurmUser=" + name + "\nSlurmdUser=" + name +
           "\nAuthType=auth/munge\nAuthInfo=socket=" + file("run/munge") +
           "\nCredType=cred/munge\nSlurmctldPort=" + std::to_string(freePort()) +
           "\nSlurmdPort=" + std::to_string(freePort()) + "\nSlurmctldPidFile=" + file("run/slurmctld.pid") +
           "\nSlurmdPidFile=" + file("run/slurmd.pid") + "\nSlurmctldLogFile=" + file("slurmctld.log") +
           "\nSlurmdLogFile=" + file("slurmd.log") + "\nStateSaveLocation=" + file("state") +
           "\nSlurmdSpoolDir=" + file("spool") +
           "\nProctrackType=proctrack/pgid\nTaskPlugin=task/none\nSwitchType=switch/none\nMpiDefault=none\n"
           "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\nSchedulerType=sched/backfill\n"
           "SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1\nReturnToService=2\nKillWait=5\n"
           "MinJobAge=30\nJobAcctGatherType=jobacct_gather/none\n"
           "AccountingStorageType=accounting_storage/none\nNodeName=localhost NodeAddr=localhost NodeHostname=" +
           system.nodename +
           " CPUs=1 State=UNKNOWN\nPartitionName=main Nodes=localhost Default=YES MaxTime=INFINITE State=UP\n";
  }

  std::filesystem::path folder_;
  std::vector<pid_t> processes_;
};

}  // namespace lumivox::test
