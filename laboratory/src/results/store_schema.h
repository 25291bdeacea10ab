// The schema of the results store. docs/results.md describes every column; a test compares the two.
#pragma once

#include <cstdint>

namespace lumivox::results {

inline constexpr std::int64_t kSchemaVersion = 8;           // PRAGMA user_version
inline constexpr std::int64_t kApplicationId = 0x4c4d5658;  // PRAGMA application_id: "LMVX"

inline constexpr const char* kSchema = R"sql(
CREATE TABLE runs (
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,
  created TEXT NOT NULL,
  version TEXT NOT NULL,
  scene TEXT NOT NULL,
  scene_name TEXT NOT NULL,
  pipeline TEXT NOT NULL,
  pipeline_name TEXT NOT NULL,
  sweep TEXT NOT NULL,
  is_default INTEGER NOT NULL,
  camera TEXT NOT NULL,
  time REAL NOT NULL,
  width INTEGER NOT NULL,
  height INTEGER NOT NULL,
  seed INTEGER NOT NULL,
  seeds INTEGER NOT NULL,
  repeats INTEGER NOT NULL,
  subpixels INTEGER NOT NULL,
  truth_samples INTEGER NOT NULL,
  device TEXT NOT NULL,
  driver TEXT NOT NULL,
  shader_input TEXT NOT NULL,
  host TEXT NOT NULL,
  framework_share REAL,
  failure TEXT NOT NULL,
  command TEXT NOT NULL
) STRICT;
CREATE INDEX runs_by_scene ON runs (scene_name, pipeline_name);
CREATE TABLE parameters (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  name TEXT NOT NULL,
  value TEXT NOT NULL,
  PRIMARY KEY (run, name)
) STRICT, WITHOUT ROWID;
CREATE TABLE provenance (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  kind TEXT NOT NULL,
  name TEXT NOT NULL,
  hash TEXT NOT NULL,
  PRIMARY KEY (run, kind, name)
) STRICT, WITHOUT ROWID;
CREATE TABLE timings (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  what TEXT NOT NULL,
  pass TEXT NOT NULL,
  median_ms REAL,
  lower_quartile_ms REAL,
  upper_quartile_ms REAL,
  smallest_ms REAL,
  largest_ms REAL,
  repeats INTEGER NOT NULL,
  PRIMARY KEY (run, what, pass)
) STRICT, WITHOUT ROWID;
CREATE TABLE passes (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
CREATE TABLE resources (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  what TEXT NOT NULL,
  pass TEXT NOT NULL,
  bytes INTEGER NOT NULL,
  PRIMARY KEY (run, what, pass)
) STRICT, WITHOUT ROWID;
CREATE TABLE errors (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  output TEXT NOT NULL,
  component TEXT NOT NULL,
  truth TEXT NOT NULL,
  against TEXT NOT NULL,
  seeds INTEGER NOT NULL,
  deterministic INTEGER NOT NULL,
  noise_rmse REAL,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
CREATE TABLE metrics (
  run INTEGER NOT NULL,
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  value REAL,
  uncertainty REAL,
  of_nothing REAL,
  PRIMARY KEY (run, position, name),
  FOREIGN KEY (run, position) REFERENCES errors ON DELETE CASCADE
) STRICT, WITHOUT ROWID;
CREATE TABLE health (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  finding TEXT NOT NULL,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
)sql";

/// Additions of schema 2 to schema 1.
inline constexpr const char* kSchema2 = R"sql(
CREATE TABLE stress_cells (
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,
  created TEXT NOT NULL,
  version TEXT NOT NULL,
  family TEXT NOT NULL,
  name TEXT NOT NULL,
  pipeline TEXT NOT NULL,
  technique TEXT NOT NULL,
  size TEXT NOT NULL,
  outcome TEXT NOT NULL,
  measure TEXT NOT NULL,
  unit TEXT NOT NULL,
  value REAL,
  uncertainty REAL,
  limit_value REAL,
  detail TEXT NOT NULL,
  explanation TEXT NOT NULL,
  picture TEXT NOT NULL,
  command TEXT NOT NULL,
  seconds REAL NOT NULL,
  pipeline_hash TEXT NOT NULL,
  framework TEXT NOT NULL,
  device TEXT NOT NULL,
  driver TEXT NOT NULL,
  shader_input TEXT NOT NULL,
  host TEXT NOT NULL
) STRICT;
CREATE TABLE stress_provenance (
  cell INTEGER NOT NULL REFERENCES stress_cells ON DELETE CASCADE,
  technique TEXT NOT NULL,
  hash TEXT NOT NULL,
  PRIMARY KEY (cell, technique)
) STRICT, WITHOUT ROWID;
CREATE TABLE ceilings (
  device TEXT NOT NULL,
  driver TEXT NOT NULL,
  shader_input TEXT NOT NULL,
  host TEXT NOT NULL,
  name TEXT NOT NULL,
  unit TEXT NOT NULL,
  created TEXT NOT NULL,
  version TEXT NOT NULL,
  median REAL NOT NULL,
  lower_quartile REAL NOT NULL,
  upper_quartile REAL NOT NULL,
  smallest REAL NOT NULL,
  largest REAL NOT NULL,
  repeats INTEGER NOT NULL,
  PRIMARY KEY (device, driver, shader_input, host, name)
) STRICT, WITHOUT ROWID;
)sql";

/// Additions of schema 3 to schema 2.
inline constexpr const char* kSchema3 = R"sql(
CREATE TABLE work (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  pass TEXT NOT NULL,
  name TEXT NOT NULL,
  amount REAL NOT NULL,
  PRIMARY KEY (run, pass, name)
) STRICT, WITHOUT ROWID;
)sql";

/// Additions of schema 4 to schema 3.
inline constexpr const char* kSchema4 = R"sql(
ALTER TABLE errors ADD COLUMN per_seed INTEGER NOT NULL DEFAULT 0;
CREATE TABLE notes (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  note TEXT NOT NULL,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
CREATE TABLE pictures (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  output TEXT NOT NULL,
  component TEXT NOT NULL,
  truth TEXT NOT NULL,
  flip REAL,
  png BLOB NOT NULL,
  PRIMARY KEY (run, position)
) STRICT;
CREATE TABLE controls (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  created TEXT NOT NULL,
  what TEXT NOT NULL,
  median_ms REAL NOT NULL,
  lower_quartile_ms REAL NOT NULL,
  upper_quartile_ms REAL NOT NULL,
  repeats INTEGER NOT NULL,
  PRIMARY KEY (run, created, what)
) STRICT, WITHOUT ROWID;
CREATE TABLE claims (
  key TEXT PRIMARY KEY,
  machine TEXT NOT NULL,
  process INTEGER NOT NULL,
  started INTEGER NOT NULL,
  command TEXT NOT NULL,
  expires INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
)sql";

/// Changes of schema 5 to schema 4: one word for each thing.
inline constexpr const char* kSchema5 = R"sql(
ALTER TABLE runs RENAME COLUMN truth_samples TO reference_samples;
ALTER TABLE errors RENAME COLUMN truth TO reference;
ALTER TABLE stress_cells RENAME COLUMN picture TO image;
UPDATE stress_cells SET family = 'image_and_camera' WHERE family = 'picture_and_camera';
ALTER TABLE ceilings RENAME TO peak_rates;
ALTER TABLE pictures RENAME TO images;
ALTER TABLE images RENAME COLUMN truth TO reference;
UPDATE metrics SET name = 'non_finite_reference' WHERE name = 'non_finite_truth';
UPDATE metrics SET name = 'non_finite_image' WHERE name = 'non_finite_picture';
)sql";

/// What schema 6 adds to schema 5: runs that lack their times.
inline constexpr const char* kSchema6 = R"sql(
ALTER TABLE runs ADD COLUMN complete INTEGER NOT NULL DEFAULT 1;
)sql";

/// What schema 7 adds to schema 6: the voxels that a run's indirect light is gathered from.
inline constexpr const char* kSchema7 = R"sql(
CREATE TABLE voxels (
  run INTEGER PRIMARY KEY REFERENCES runs ON DELETE CASCADE,
  output TEXT NOT NULL,
  kind TEXT NOT NULL,
  why_not TEXT NOT NULL,
  width INTEGER NOT NULL,
  height INTEGER NOT NULL,
  depth INTEGER NOT NULL,
  occupied INTEGER NOT NULL,
  reference INTEGER NOT NULL,
  undecided INTEGER NOT NULL,
  true_positive INTEGER NOT NULL,
  false_positive INTEGER NOT NULL,
  false_negative INTEGER NOT NULL,
  axis_crossings INTEGER NOT NULL,
  axis_holes INTEGER NOT NULL,
  oblique_crossings INTEGER NOT NULL,
  oblique_holes INTEGER NOT NULL,
  recall REAL,
  precision REAL
) STRICT;
)sql";

/// What schema 8 adds to schema 7: the reports that share an unfinished store, and the runs that each wants.
inline constexpr const char* kSchema8 = R"sql(
CREATE TABLE reports (
  id INTEGER PRIMARY KEY,
  points TEXT NOT NULL,
  command TEXT NOT NULL,
  machine TEXT NOT NULL,
  process INTEGER NOT NULL,
  started INTEGER NOT NULL,
  expires INTEGER NOT NULL
) STRICT;
CREATE TABLE wanted (
  report INTEGER NOT NULL REFERENCES reports ON DELETE CASCADE,
  key TEXT NOT NULL,
  PRIMARY KEY (report, key)
) STRICT, WITHOUT ROWID;
CREATE INDEX wanted_by_key ON wanted (key);
)sql";

/// Shows the names of the last schema where an older store is only read: views of this connection, before
/// the tables.
struct NamesOfOlder {
  std::int64_t since, until;  ///< the schemas that need it, both included
  const char* view;
};
inline constexpr NamesOfOlder kNamesOfOlder[] = {
    {1, 4,
     "CREATE TEMP VIEW runs AS SELECT *, truth_samples AS reference_samples, 1 AS complete FROM main.runs"},
    {5, 5, "CREATE TEMP VIEW runs AS SELECT *, 1 AS complete FROM main.runs"},
    {1, 4,
     "CREATE TEMP VIEW metrics AS SELECT run, position, CASE name WHEN 'non_finite_truth' THEN "
     "'non_finite_reference' WHEN 'non_finite_picture' THEN 'non_finite_image' ELSE name END AS name, value, "
     "uncertainty, of_nothing FROM main.metrics"},
    {2, 4,
     "CREATE TEMP VIEW stress_cells AS SELECT id, key, created, version, replace(family, "
     "'picture_and_camera', 'image_and_camera') AS family, name, pipeline, technique, size, outcome, measure, "
     "unit, value, uncertainty, limit_value, detail, explanation, picture AS image, command, seconds, "
     "pipeline_hash, framework, device, driver, shader_input, host FROM main.stress_cells"},
    {2, 4, "CREATE TEMP VIEW peak_rates AS SELECT * FROM main.ceilings"},
    {4, 4, "CREATE TEMP VIEW images AS SELECT *, truth AS reference FROM main.pictures"},
};

}  // namespace lumivox::results
