// Job arrays of Slurm (sbatch, sacct, squeue).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lumivox::command {

/// What a submission needs. Scripts are those of a POSIX shell.
struct SlurmArray {
  std::string name;                  ///< of the job
  std::filesystem::path folder;      ///< of the scripts and what the tasks write
  std::size_t tasks = 0;             ///< $SLURM_ARRAY_TASK_ID counts from 1
  std::string task, merge;           ///< commands of one task, and of the job after the last of them
  bool exclusive = false;            ///< nodes of their own, since times are taken
  bool mergeExclusive = false;       ///< the same of the job after them
  std::vector<std::string> options;  ///< further ones of sbatch, for both jobs
};

struct SubmittedArray {
  std::string array, merge;  ///< numbers of the jobs
};

/// Error, before anything is written, if there is no sbatch, or if an option is one that the array sets
/// itself.
void requireSlurm(const std::vector<std::string>& options);
/// Writes both scripts and submits them; the second begins when the array has ended, however it did. Error
/// with what sbatch said when it fails; then no job is left waiting.
SubmittedArray submit(const SlurmArray& array);

/// How far a job array is.
struct ArrayState {
  std::size_t ended = 0, running = 0, failed = 0;  ///< tasks; failed: of those that ended
  double secondsOfEnded = 0.0;                     ///< their sum
};
/// From the lines "ID_TASK|STATE|SECONDS" of sacct.
ArrayState stateFrom(const std::string& lines);

/// Shows the progress of the array, with the time that is left by the tasks that have ended, until the job
/// after it has ended. Returns the last state of the array.
ArrayState waitFor(const SubmittedArray& jobs, std::size_t tasks);

}  // namespace lumivox::command
