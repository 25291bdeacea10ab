// Tables and figures of papers as texts: the published set-up is measured or shown. Numbers are compared as
// ratios to the table's first row, since no two devices have the same times; curves by how they grow;
// pictures by whoever looks at them.
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
inline constexpr PublishedQuantity kPublishedQuantities[] = {
    PublishedQuantity::time, PublishedQuantity::frameRate, PublishedQuantity::fragments,
    PublishedQuantity::memory};
const char* name(PublishedQuantity quantity);  ///< "frame_rate"
const char* unit(PublishedQuantity quantity);  ///< "1/s"

/// What is measured or shown for one number, point or panel.
struct PublishedSetUp {
  SourcePlace place;
  PublishedQuantity quantity = PublishedQuantity::time;
  std::filesystem::path scene;
  std::shared_ptr<const Pipeline> pipeline;  ///< null with `absent`, and where the reference is shown
  std::string camera;
  double time = 0.0;  ///< s
  ParameterValues settings;
  int subdivisions = 0;             ///< how often every triangle of the scene is split into four before
  std::vector<std::string> passes;  ///< whose times or bytes are added up; empty: the whole frame
  std::string pass,
      port;  ///< an output that is kept: its fragments are counted, its picture is shown; may be empty
  std::string absent;      ///< why it cannot be measured
  std::string substitute;  ///< what stands in for the published set-up, so that a verdict would not count
};

/// One number of a published table, and how it is measured here.
struct PublishedRow : PublishedSetUp {
  std::string name;
  double published = 0.0;  ///< in the quantity's unit
  std::string over;        ///< the row that it is divided by; empty: the first one
};

/// What a paper says of how a number grows.
enum class Growth { unsaid, sublinear, linear, superlinear };
const char* name(Growth growth);

/// One curve of a figure.
struct PublishedCurve {
  std::string name;
  SourcePlace place;
  std::string over;  ///< "triangles" of the scene, or a parameter of the pipeline: the horizontal axis
  Growth growth = Growth::unsaid;
  std::vector<PublishedSetUp> points;  ///< all of one quantity
};

/// One picture of a figure: an output of a pass, the whole picture of the pipeline, or a layer of the
/// reference.
struct PublishedPanel : PublishedSetUp {
  std::string name;
  std::string reference;  ///< layer of the path-traced reference in place of a pipeline; empty: none
};

/// A text `*.reproduction`: one published table or figure.
struct PublishedResult {
  std::filesystem::path file;
  std::string id;  ///< "004-table-3"
  std::string title, paper, device;
  int width = 0, height = 0;        ///< of the published picture; 0: the camera's
  std::vector<std::string> scaled;  ///< parameters that a reduced set-up makes smaller with the picture
  double softwareScale = 1.0;       ///< reduction by default on a software rasteriser
  std::vector<std::string>
      differences;  ///< of the set-up from the published one that do not change the verdict
  std::vector<PublishedRow> rows;
  std::vector<PublishedCurve> curves;
  std::vector<PublishedPanel> panels;
  int columns = 0;  ///< of the sheet that holds the panels; 0: as square as it goes
  std::shared_ptr<const dsl::Document> document;

  /// Throws DiagnosticsError with every finding that needs no technique library, those of its pipelines among
  /// them.
  static PublishedResult load(const std::filesystem::path& file);
  /// Of rows, points and panels, in the order of the text.
  std::vector<const PublishedSetUp*> setUps() const;
};

/// Tables of the grammar, for describe and the reference.
const std::vector<dsl::BlockSpecification>& reproductionSpecifications();

/// All findings against the techniques.
void checkReproduction(const PublishedResult& result, TechniqueSource& techniques);

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

/// One set-up as far as it could be measured.
struct MeasuredSetUp {
  std::optional<TimingStatistics> measured;  ///< in that unit, but for frame rates, which are frame times, ms
  std::string whyNot;                        ///< not comparable, measured or not
  bool failed = false;                       ///< it should have been measured, and something went wrong
};
struct MeasuredRow : MeasuredSetUp {
  std::string name;
  PublishedQuantity quantity = PublishedQuantity::time;
  double published = 0.0;  ///< in the quantity's unit
  std::string over;        ///< the row that it is divided by; empty: the first one
};
struct MeasuredPoint : MeasuredSetUp {
  double x = 0.0;  ///< NaN where it is not known, since its scene is not here
};
struct MeasuredCurve {
  std::string name, over;
  PublishedQuantity quantity = PublishedQuantity::time;
  Growth growth = Growth::unsaid;
  std::vector<MeasuredPoint> points;
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
struct JudgedCurve {
  Verdict verdict = Verdict::notComparable;
  std::string why;
  Measured exponent;  ///< of the power law through the medians; NaN where there is none
};

/// The rule. Times and frame rates are divided by the first row of either that is comparable, fragments and
/// memory by the first of their own; a row that says so by the row that it names. A table is reproduced when
/// at least one row is, none is not, and no two comparable rows stand in the other order than published by
/// more than their uncertainty.
JudgedTable judge(const std::vector<MeasuredRow>& rows);

/// A curve follows x^p; p reaches so many of its standard uncertainties to both sides as a ratio does.
/// Sublinear is reproduced when all of that lies below 1, superlinear when above, and not when all of it lies
/// on the other side. Linear: when from the first point to the last the curve grows as x does within the
/// factor of ratios.
JudgedCurve judgeGrowth(const MeasuredCurve& curve);

// ---- measuring -----------------------------------------------------------------------------------------

struct ReproduceOptions {
  double scale = 0.0;  ///< of picture sides and scaled parameters, above 0 to 1; 0: the table's own
  int repeats = 5;     ///< timed frames; those of all rows take turns
  std::uint64_t seed = 1;
  int truthSamples = 0;  ///< per pixel, for the errors that go to a store; 0: truthSamplesFor()
  std::vector<std::string> repeatArguments;  ///< further options that a repeating command needs
};

/// A picture of a figure.
struct ShownPanel {
  std::string name;
  Picture picture;     ///< linear; empty where there is none
  std::string whyNot;  ///< why there is none, or what stands in for it
  bool failed = false;
  double meanLuminance = 0.0;  ///< W/(sr m²); NaN where there is no picture
};

struct ReproducedResult {
  PublishedResult published;
  std::vector<MeasuredRow> rows;
  JudgedTable judged;  ///< the rows
  std::vector<MeasuredCurve> curves;
  std::vector<JudgedCurve> judgedCurves;
  std::vector<ShownPanel> panels;
  double exposure = 1.0;  ///< one for all panels
  double scale = 1.0;
  std::vector<std::string> setUps;  ///< "scenes/a.scene, a.pipeline: resolution=64, 256 x 192 pixels"
  gpu::DeviceInfo device;
  std::string host, date, command;
  int repeats = 0;
  bool failed() const;  ///< something should have been measured, and went wrong
};

/// Measures every row and point whose set-up is here, and renders every panel. An absent model or technique
/// and a pass that the scene does not need make a row not comparable. `store`: takes every set-up that was
/// timed as a sweep would store it: its times, and then, apart from them, its errors and the work of its
/// passes. Throws DiagnosticsError for a wrong text.
ReproducedResult reproduce(gpu::Device& device, TechniqueSet& techniques, const PublishedResult& published,
                           const ReproduceOptions& options,
                           const std::function<Scene(const std::filesystem::path&)>& loadScene,
                           ResultsStore* store = nullptr);

// ---- for readers ---------------------------------------------------------------------------------------

/// Markdown, or a page of HTML with sheets and curves in it.
std::string reproductionsAsMarkdown(const std::vector<ReproducedResult>& results);
std::string reproductionsAsHtml(const std::vector<ReproducedResult>& results);
/// The cells of one row: name, published and measured number, both ratios, verdict.
std::vector<std::string> reproductionCells(const MeasuredRow& row, const JudgedRow& judged);
/// Under these words.
const std::vector<std::string>& reproductionHeadings();
/// Rows as a table of Markdown.
std::string reproductionTable(const std::vector<MeasuredRow>& rows, const JudgedTable& judged);
/// "Reproduced: ...", with the count of rows; empty for a result of pictures alone.
std::string verdictText(const ReproducedResult& result);
/// "triangles^0.93 ± 0.02 (published: sublinear), reproduced".
std::string curveText(const MeasuredCurve& curve, const JudgedCurve& judged);
/// The rule in words.
std::string reproductionRule();
/// Devices, the reduction, what was measured and how it differs, for whoever reads the numbers.
std::vector<std::string> reproductionNotes(const ReproducedResult& result);

/// All panels under one exposure, each with its name, those that are absent with the reason, as display
/// values in [0,1] for encodePng. Error without panels.
Picture contactSheet(const ReproducedResult& result);
/// The points of all curves: curve, x and its name, median, quartiles, unit, repeats, why not (RFC 4180).
std::string curvesAsCsv(const ReproducedResult& result);
/// The curves side by side on logarithmic axes, with quartiles, and a line of slope 1 to compare with.
std::string curvesAsSvg(const ReproducedResult& result);

// ---- kept ----------------------------------------------------------------------------------------------

/// A file of results as they were measured, without the pixels of pictures. What is judged is judged anew on
/// reading.
std::string reproductionsAsJson(const std::vector<ReproducedResult>& results);
/// Error that names the file and the place for anything that reproductionsAsJson() does not write.
std::vector<ReproducedResult> readReproductions(const std::filesystem::path& file);

/// Markdown with passages between `<!-- reproduced KIND ID; NAME; ... -->` and `<!-- end -->` that are
/// written from kept results:
///     table ID               all rows that were measured
///     ratios ID; ROW; ...    those rows as 1 : a : b, each divided by the first, as measured and as
///     published curve ID; CURVE        how it grows
/// Error that names `file` and the line for a passage that is not closed, of an unknown kind, or whose
/// result, row or curve is not there.
std::string withReproducedPassages(const std::string& markdown, const std::filesystem::path& file,
                                   const std::vector<ReproducedResult>& results);

/// How kept results differ from the texts that they were measured by: rows, curves and published numbers.
/// Empty: they fit.
std::vector<std::string> staleReproductions(const std::vector<ReproducedResult>& results,
                                            const std::vector<PublishedResult>& published);

}  // namespace lumivox
