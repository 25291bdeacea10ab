// What a test program tells of its cases, and which of them it runs. A process runs all cases of a test file;
// ./test reads what each says, so that a case can be chosen, skipped, timed and blamed for a crash as if it
// ran alone.
#pragma once

#include <string>

namespace lumivox::test {

/// In the file that LUMIVOX_TEST_EVENTS (a folder) asks for: that the case that runs does not apply here.
void noteSkipped(const std::string& reason);

/// Runs the cases that the arguments choose (Catch2's), of them those whose "file: sentence" matches the
/// regular expression in LUMIVOX_TEST_CASES, without those listed in the file LUMIVOX_TEST_WITHOUT; with
/// LUMIVOX_TEST_SHARE=2/4 every fourth from the second on. `--cases` as the only argument lists them. A case
/// that takes longer than LUMIVOX_TEST_LIMIT (s, default 600) ends the process.
int runCases(int count, char** arguments);

}  // namespace lumivox::test
