// Selects the cases that a test program runs, and reports them. A process runs all cases of a test file.
// ./test reads the reports, so that each case can be chosen, skipped, timed and blamed for a crash as if it
// ran alone.
#pragma once

#include <string>

namespace lumivox::test {

/// Reports, in a file of the folder LUMIVOX_TEST_EVENTS, that the running case does not apply here.
void noteSkipped(const std::string& reason);

/// Runs the cases that Catch2's arguments choose. Of these it takes the ones whose "file: sentence" matches
/// the regular expression in LUMIVOX_TEST_CASES, without those listed in the file LUMIVOX_TEST_WITHOUT, and
/// with LUMIVOX_TEST_SHARE=2/4 every fourth from the second on. `--cases` as the only argument lists the
/// cases. A case that takes longer than LUMIVOX_TEST_LIMIT (s, default 600) ends the process.
int runCases(int count, char** arguments);

}  // namespace lumivox::test
