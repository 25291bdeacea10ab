// Tables of papers as texts: the published set-up is measured, and the numbers are compared as ratios to the
// table's first row, since no two devices have the same times.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/report/store.h"

namespace lumivox {

/// What a published number measures, and its unit in the text.
enum class PublishedQuantity {
  time,       ///< of passes or of the frame, ms
  frameRate,  ///< of the frame, 1/s; compared as the frame's time
  fragments,  ///< voxel fragments of an output, a number
  memory      ///< of passes, or of the whole frame at its peak, MB (10^6 bytes)
};
const char* name(PublishedQuantity quantity);  ///< "frame_rate"
const char* unit(PublishedQuantity quantity);  ///< "1/s"

/// One number of a published table, and how it is measured here.
struct PublishedRow {
  std::string name;
  SourcePlace place;
  double published = 0.0;  ///< in the quantity's unit
  PublishedQuantity quantity = PublishedQuantity::time;
  std::filesystem::path scene;
  std::shared_ptr<const Pipeline> pipeline;  ///< null with `absent`
  std::string camera;
  double time = 0.0;  ///< s
  ParameterValues settings;
  std::vector<std::string> passes;  ///< whose times or bytes are added up; empty: the whole frame
  std::string pass, port;           ///< an output that is kept, and whose fragments are counted; may be empty
  std::string absent;               ///< why it cannot be measured
  std::string substitute;  ///< what stands in for the published set-up, so that a verdict would not count
};

/// A text `*.reproduction`: one published table.
struct PublishedTable {
  std::filesystem::path file;
  std::string id;  ///< "004-table-3"
  std::string title, paper, device;
  int width = 0, height = 0;        ///< of the published picture; 0: the camera's
  std::vector<std::string> scaled;  ///< parameters that a reduced set-up makes smaller with the picture
  double softwareScale = 1.0;       ///< reduction by default on a software rasteriser
  std::vector<std::string>
      differences;  ///< of the set-up from the published one that do not change the verdict
  std::vector<PublishedRow> rows;
  std::shared_ptr<const dsl::Document> document;

  /// Throws DiagnosticsError with every finding that needs no technique library, those of its pipelines among
  /// them.
  static PublishedTable load(const std::filesystem::path& file);
};

/// Tables of the grammar, for describe and the reference.
const std::vector<dsl::BlockSpecification>& reproductionSpecifications();

/// All findings against the techniques.
void checkReproduction(const PublishedTable& table, TechniqueSource& techniques);

/// Sorted *.reproduction files of the folder `reproductions` among the committed scenes; none without such a
/// folder.
std::vector<std::filesystem::path> committedReproductions();

// ---- the rule ------------------------------------------------------------------------------------------

/// A ratio is reproduced within this factor of the published one, upwards and downwards.
inline constexpr double kReproducedFactor = 1.5;
/// A measured ratio reaches this many of its standard uncertainties to both sides (95 % of a normal
/// distribution).
inline constexpr double kReproducedSigmas = 2.0;

enum class Verdict {
  reference,      ///< the row that the others are divided by
  reproduced,     ///< the measured ratio, with its uncertainty, lies within the factor of the published one
  notReproduced,  ///< all of it lies beyond
  notComparable   ///< something of the set-up is missing, or the uncertainty reaches across the limit
};
const char* name(Verdict verdict);  ///< "not reproduced"

/// One row as far as it could be measured.
struct MeasuredRow {
  std::string name;
  PublishedQuantity quantity = PublishedQuantity::time;
  double published = 0.0;                    ///< in the quantity's unit
  std::optional<TimingStatistics> measured;  ///< in that unit, but for frame rates, which are frame times, ms
  std::string whyNot;                        ///< not comparable, measured or not
  bool failed = false;                       ///< it should have been measured, and something went wrong
};

struct JudgedRow {
  Verdict verdict = Verdict::notComparable;
  double publishedRatio = 0.0;  ///< NaN where there is none
  double ratio = 0.0, lowRatio = 0.0,
         highRatio = 0.0;  ///< measured, and as far as it reaches; NaN where there is none
  std::string why;         ///< of a row that is not comparable
};
struct JudgedTable {
  Verdict verdict = Verdict::notComparable;
  std::string why;
  std::vector<JudgedRow> rows;
};

/// The rule. Times and frame rates are divided by the first row of either that is comparable, fragments and
/// memory by the first of their own. A table is reproduced when at least one row is, none is not, and no two
/// comparable rows stand in the other order than published by more than their uncertainty.
JudgedTable judge(const std::vector<MeasuredRow>& rows);

// ---- measuring -----------------------------------------------------------------------------------------

struct ReproduceOptions {
  double scale = 0.0;  ///< of picture sides and scaled parameters, above 0 to 1; 0: the table's own
  int repeats = 5;     ///< timed frames; those of all rows take turns
  std::uint64_t seed = 1;
  int truthSamples = 0;  ///< per pixel, for the errors that go to a store; 0: truthSamplesFor()
  std::vector<std::string> repeatArguments;  ///< further options that a repeating command needs
};

struct ReproducedTable {
  PublishedTable table;
  std::vector<MeasuredRow> rows;
  JudgedTable judged;
  double scale = 1.0;
  std::vector<std::string> setUps;  ///< "scenes/a.scene, a.pipeline: resolution=64, 256 x 192 pixels"
  gpu::DeviceInfo device;
  std::string host, date, command;
};

/// Measures every row whose set-up is here. An absent model or technique and a pass that the scene does not
/// need make a row not comparable. `store`: takes every set-up as a sweep would store it: its times, and
/// then, apart from them, its errors and the work of its passes. Throws DiagnosticsError for a wrong text.
ReproducedTable reproduce(gpu::Device& device, TechniqueSet& techniques, const PublishedTable& table,
                          const ReproduceOptions& options,
                          const std::function<Scene(const std::filesystem::path&)>& loadScene,
                          ResultsStore* store = nullptr);

/// The measured tables for readers: Markdown, or a page of HTML.
std::string reproductionsAsMarkdown(const std::vector<ReproducedTable>& tables);
std::string reproductionsAsHtml(const std::vector<ReproducedTable>& tables);
/// The cells of one row: name, published and measured number, both ratios, verdict.
std::vector<std::string> reproductionCells(const PublishedRow& row, const MeasuredRow& measured,
                                           const JudgedRow& judged);
/// "Reproduced: ...", with the count of rows.
std::string verdictText(const ReproducedTable& table);
/// The rule in words.
std::string reproductionRule();
/// Devices, the reduction, what was measured and how it differs, for whoever reads the numbers.
std::vector<std::string> reproductionNotes(const ReproducedTable& table);

}  // namespace lumivox
