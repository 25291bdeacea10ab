-- What version 0.1.0 wrote with schema 9, which kept a record as JSON beside its key, as SQL, without its views: a run, one that failed,
-- one without its times, two cells of the stress battery and a peak rate.
PRAGMA application_id = 1280136792;
PRAGMA user_version = 9;
PRAGMA foreign_keys=OFF;
BEGIN TRANSACTION;
CREATE TABLE runs (
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,
  complete INTEGER NOT NULL,
  created TEXT GENERATED ALWAYS AS (json_extract(record, '$.created')) VIRTUAL,
  version TEXT GENERATED ALWAYS AS (json_extract(record, '$.version')) VIRTUAL,
  scene TEXT GENERATED ALWAYS AS (json_extract(record, '$.scene')) VIRTUAL,
  scene_name TEXT GENERATED ALWAYS AS (json_extract(record, '$.scene_name')) VIRTUAL,
  pipeline TEXT GENERATED ALWAYS AS (json_extract(record, '$.pipeline')) VIRTUAL,
  pipeline_name TEXT GENERATED ALWAYS AS (json_extract(record, '$.pipeline_name')) VIRTUAL,
  sweep TEXT GENERATED ALWAYS AS (json_extract(record, '$.sweep')) VIRTUAL,
  is_default INTEGER GENERATED ALWAYS AS (json_extract(record, '$.default')) VIRTUAL,
  scene_hash TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.scene_hash')) VIRTUAL,
  pipeline_hash TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.pipeline_hash')) VIRTUAL,
  framework TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.framework')) VIRTUAL,
  camera TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.camera')) VIRTUAL,
  time REAL GENERATED ALWAYS AS (json_extract(record, '$.identity.time')) VIRTUAL,
  width INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.width')) VIRTUAL,
  height INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.height')) VIRTUAL,
  seed INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.seed')) VIRTUAL,
  seeds INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.seeds')) VIRTUAL,
  repeats INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.repeats')) VIRTUAL,
  subpixels INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.subpixels')) VIRTUAL,
  reference_samples INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.reference_samples')) VIRTUAL,
  flicker_pairs INTEGER GENERATED ALWAYS AS (json_extract(record, '$.identity.flicker_pairs')) VIRTUAL,
  display TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.display')) VIRTUAL,
  device TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.device')) VIRTUAL,
  driver TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.driver')) VIRTUAL,
  shader_input TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.shader_input')) VIRTUAL,
  host TEXT GENERATED ALWAYS AS (json_extract(record, '$.identity.host')) VIRTUAL,
  framework_share REAL GENERATED ALWAYS AS (json_extract(record, '$.framework_share')) VIRTUAL,
  peak_bytes INTEGER GENERATED ALWAYS AS (json_extract(record, '$.peak_bytes')) VIRTUAL,
  not_counted TEXT GENERATED ALWAYS AS (json_extract(record, '$.not_counted')) VIRTUAL,
  failure TEXT GENERATED ALWAYS AS (json_extract(record, '$.failure')) VIRTUAL,
  command TEXT GENERATED ALWAYS AS (json_extract(record, '$.command')) VIRTUAL,
  record TEXT NOT NULL
);
INSERT INTO runs VALUES(1,'1b179f5a72f0d15e64a7282ff4f8f4b8',1,'{"created":"2026-01-31 12:00:00 UTC","version":"0.1.0","scene":"scenes/cornell.scene","scene_name":"Cornell box","pipeline":"scenes/pipelines/voxel_cone_tracing.pipeline","pipeline_name":"Voxel cone tracing","sweep":"quality","default":true,"identity":{"scene_hash":"5ce","pipeline_hash":"919e","techniques":{"voxel_cone_tracing":"1a","voxelization":"2b"},"framework":"f0","parameters":{"cones":"1","distribution":"cosine"},"camera":"main","time":0.1,"width":64,"height":48,"seed":18446744073709551615,"seeds":1,"repeats":1,"subpixels":1,"reference_samples":37,"flicker_pairs":4,"kept":["light.radiance","voxels.fragments"],"display":"exposure -1.5, tone filmic","device":"a device, ''quoted''","driver":"","shader_input":"","host":"a host"},"frame":{"median_ms":10.0,"lower_quartile_ms":9.5,"upper_quartile_ms":10.5,"smallest_ms":9.0,"largest_ms":12.0,"repeats":5},"next_frame":{"median_ms":4.0,"lower_quartile_ms":3.9,"upper_quartile_ms":4.1,"smallest_ms":3.8,"largest_ms":5.0,"repeats":5},"still_frame":{"median_ms":1.0,"lower_quartile_ms":0.9,"upper_quartile_ms":1.1,"smallest_ms":0.8,"largest_ms":2.0,"repeats":5},"moved_frame":{"median_ms":6.0,"lower_quartile_ms":5.9,"upper_quartile_ms":6.1,"smallest_ms":5.8,"largest_ms":7.0,"repeats":5},"framework_share":null,"peak_bytes":21474836480,"passes":[{"name":"gbuffer","work":{"draws":1.0}},{"name":"gather","device":{"median_ms":6.0,"lower_quartile_ms":5.9,"upper_quartile_ms":6.1,"smallest_ms":5.8,"largest_ms":6.4,"repeats":5},"host":{"median_ms":6.5,"lower_quartile_ms":6.4,"upper_quartile_ms":6.6,"smallest_ms":6.3,"largest_ms":6.9,"repeats":5},"bytes":1048576,"work":{"buffer_reads":1000000000000.0,"texture_samples_d3_rgba16f_mips":3.0}}],"errors":[{"output":"indirect_diffuse","component":"indirect_diffuse","reference":"one_bounce_diffuse","against":"bias","seeds":2,"deterministic":true,"noise_rmse":0.0,"per_seed":true,"metrics":{"rmse":{"value":1.02,"uncertainty":0.0102,"of_nothing":0.3333333333333333},"relative_mse":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"mean_ratio":{"value":0.9,"uncertainty":null,"of_nothing":0.0},"bias":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"percentile95":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"ssim":{"value":1.0,"uncertainty":0.0,"of_nothing":1.0},"flip":{"value":0.125,"uncertainty":0.001,"of_nothing":0.0},"flip_ldr":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"rms_bias":{"value":0.51,"uncertainty":0.02,"of_nothing":0.3333333333333333},"rms_noise":{"value":null,"uncertainty":0.0,"of_nothing":0.0},"flicker":{"value":0.25,"uncertainty":0.001,"of_nothing":null},"exposure_ev":{"value":-1.25,"uncertainty":0.0,"of_nothing":null},"noise_floor":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"non_finite_image":{"value":7.0,"uncertainty":0.0,"of_nothing":0.0},"non_finite_reference":{"value":3.0,"uncertainty":0.0,"of_nothing":0.0}}}],"voxels":{"output":"voxels.fragments","kind":"VoxelFragments","why_not":"","resolution":[32,16,8],"occupied":103,"reference":100,"undecided":7,"true_positive":80,"false_positive":20,"false_negative":20,"holes":{"axis_crossings":400,"axis_holes":10,"oblique_crossings":300,"oblique_holes":3},"recall":0.8,"precision":0.8,"axis_holes":0.025,"oblique_holes":0.01},"health":["pass gather, port diffuse: 3 NaN, first at pixel (12, 40)"],"notes":["6 of 8 layers were used"],"not_counted":"only this pass","failure":"","command":"lumivox report scenes/cornell.scene"}');
INSERT INTO runs VALUES(2,'a5a1f1070884105c3f4ef2ba6a7468ef',1,'{"created":"2026-01-31 12:00:00 UTC","version":"0.1.0","scene":"scenes/cornell.scene","scene_name":"Cornell box","pipeline":"scenes/pipelines/voxel_cone_tracing.pipeline","pipeline_name":"Voxel cone tracing","sweep":"quality","default":true,"identity":{"scene_hash":"5ce","pipeline_hash":"919e","techniques":{"voxel_cone_tracing":"1a","voxelization":"2b"},"framework":"f0","parameters":{"cones":"2","distribution":"cosine"},"camera":"main","time":0.1,"width":64,"height":48,"seed":18446744073709551615,"seeds":1,"repeats":1,"subpixels":1,"reference_samples":0,"flicker_pairs":4,"kept":["light.radiance","voxels.fragments"],"display":"exposure -1.5, tone filmic","device":"a device, ''quoted''","driver":"","shader_input":"","host":"a host"},"frame":{"median_ms":10.0,"lower_quartile_ms":9.5,"upper_quartile_ms":10.5,"smallest_ms":9.0,"largest_ms":12.0,"repeats":5},"next_frame":{"median_ms":4.0,"lower_quartile_ms":3.9,"upper_quartile_ms":4.1,"smallest_ms":3.8,"largest_ms":5.0,"repeats":5},"still_frame":{"median_ms":1.0,"lower_quartile_ms":0.9,"upper_quartile_ms":1.1,"smallest_ms":0.8,"largest_ms":2.0,"repeats":5},"moved_frame":{"median_ms":6.0,"lower_quartile_ms":5.9,"upper_quartile_ms":6.1,"smallest_ms":5.8,"largest_ms":7.0,"repeats":5},"framework_share":null,"peak_bytes":21474836480,"passes":[{"name":"gbuffer","work":{"draws":1.0}},{"name":"gather","device":{"median_ms":6.0,"lower_quartile_ms":5.9,"upper_quartile_ms":6.1,"smallest_ms":5.8,"largest_ms":6.4,"repeats":5},"host":{"median_ms":6.5,"lower_quartile_ms":6.4,"upper_quartile_ms":6.6,"smallest_ms":6.3,"largest_ms":6.9,"repeats":5},"bytes":1048576,"work":{"buffer_reads":1000000000000.0,"texture_samples_d3_rgba16f_mips":3.0}}],"errors":[],"voxels":null,"health":["pass gather, port diffuse: 3 NaN, first at pixel (12, 40)"],"notes":[],"not_counted":"only this pass","failure":"it did not fit","command":"lumivox report scenes/cornell.scene"}');
INSERT INTO runs VALUES(3,'bcc2577ef4d4fdc939622c27f94ef1bb',0,'{"created":"2026-01-31 12:00:00 UTC","version":"0.1.0","scene":"scenes/cornell.scene","scene_name":"Cornell box","pipeline":"scenes/pipelines/voxel_cone_tracing.pipeline","pipeline_name":"Voxel cone tracing","sweep":"quality","default":true,"identity":{"scene_hash":"5ce","pipeline_hash":"919e","techniques":{"voxel_cone_tracing":"1a","voxelization":"2b"},"framework":"f0","parameters":{"cones":"1","distribution":"cosine"},"camera":"main","time":0.1,"width":64,"height":48,"seed":18446744073709551615,"seeds":1,"repeats":1,"subpixels":1,"reference_samples":37,"flicker_pairs":4,"kept":["light.radiance","voxels.fragments"],"display":"exposure -1.5, tone filmic","device":"a device, ''quoted''","driver":"","shader_input":"","host":"a host"},"frame":{"median_ms":10.0,"lower_quartile_ms":9.5,"upper_quartile_ms":10.5,"smallest_ms":9.0,"largest_ms":12.0,"repeats":5},"next_frame":{"median_ms":4.0,"lower_quartile_ms":3.9,"upper_quartile_ms":4.1,"smallest_ms":3.8,"largest_ms":5.0,"repeats":5},"still_frame":{"median_ms":1.0,"lower_quartile_ms":0.9,"upper_quartile_ms":1.1,"smallest_ms":0.8,"largest_ms":2.0,"repeats":5},"moved_frame":{"median_ms":6.0,"lower_quartile_ms":5.9,"upper_quartile_ms":6.1,"smallest_ms":5.8,"largest_ms":7.0,"repeats":5},"framework_share":null,"peak_bytes":21474836480,"passes":[{"name":"gbuffer","work":{"draws":1.0}},{"name":"gather","device":{"median_ms":6.0,"lower_quartile_ms":5.9,"upper_quartile_ms":6.1,"smallest_ms":5.8,"largest_ms":6.4,"repeats":5},"host":{"median_ms":6.5,"lower_quartile_ms":6.4,"upper_quartile_ms":6.6,"smallest_ms":6.3,"largest_ms":6.9,"repeats":5},"bytes":1048576,"work":{"buffer_reads":1000000000000.0,"texture_samples_d3_rgba16f_mips":3.0}}],"errors":[{"output":"indirect_diffuse","component":"indirect_diffuse","reference":"one_bounce_diffuse","against":"bias","seeds":2,"deterministic":true,"noise_rmse":0.0,"per_seed":true,"metrics":{"rmse":{"value":1.02,"uncertainty":0.0102,"of_nothing":0.3333333333333333},"relative_mse":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"mean_ratio":{"value":0.9,"uncertainty":null,"of_nothing":0.0},"bias":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"percentile95":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"ssim":{"value":1.0,"uncertainty":0.0,"of_nothing":1.0},"flip":{"value":0.125,"uncertainty":0.001,"of_nothing":0.0},"flip_ldr":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"rms_bias":{"value":0.51,"uncertainty":0.02,"of_nothing":0.3333333333333333},"rms_noise":{"value":null,"uncertainty":0.0,"of_nothing":0.0},"flicker":{"value":0.25,"uncertainty":0.001,"of_nothing":null},"exposure_ev":{"value":-1.25,"uncertainty":0.0,"of_nothing":null},"noise_floor":{"value":0.0,"uncertainty":0.0,"of_nothing":0.0},"non_finite_image":{"value":7.0,"uncertainty":0.0,"of_nothing":0.0},"non_finite_reference":{"value":3.0,"uncertainty":0.0,"of_nothing":0.0}}}],"voxels":{"output":"voxels.fragments","kind":"VoxelFragments","why_not":"","resolution":[32,16,8],"occupied":103,"reference":100,"undecided":7,"true_positive":80,"false_positive":20,"false_negative":20,"holes":{"axis_crossings":400,"axis_holes":10,"oblique_crossings":300,"oblique_holes":3},"recall":0.8,"precision":0.8,"axis_holes":0.025,"oblique_holes":0.01},"health":["pass gather, port diffuse: 3 NaN, first at pixel (12, 40)"],"notes":["6 of 8 layers were used"],"not_counted":"only this pass","failure":"","command":"lumivox report scenes/cornell.scene"}');
CREATE TABLE images (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  output TEXT NOT NULL,
  component TEXT NOT NULL,
  reference TEXT NOT NULL,
  flip REAL,
  png BLOB NOT NULL,
  PRIMARY KEY (run, position)
) STRICT;
INSERT INTO images VALUES(1,0,'final','full','full',0.25,X'706e67');
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
INSERT INTO controls VALUES(1,'2026-11-25 19:08:12 UTC','frame',12.0,11.499999999999999999,12.5,5);
INSERT INTO controls VALUES(1,'2026-11-25 19:08:12 UTC','next_frame',4.2000000000000001776,4.0999999999999996447,4.2999999999999998223,5);
CREATE TABLE claims (
  key TEXT PRIMARY KEY,
  machine TEXT NOT NULL,
  process INTEGER NOT NULL,
  started INTEGER NOT NULL,
  command TEXT NOT NULL,
  expires INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE TABLE reports (
  id INTEGER PRIMARY KEY,
  points TEXT NOT NULL,
  machine TEXT NOT NULL,
  process INTEGER NOT NULL,
  started INTEGER NOT NULL,
  command TEXT NOT NULL,
  expires INTEGER NOT NULL
) STRICT;
CREATE TABLE wanted (
  report INTEGER NOT NULL REFERENCES reports ON DELETE CASCADE,
  key TEXT NOT NULL,
  PRIMARY KEY (report, key)
) STRICT, WITHOUT ROWID;
CREATE TABLE stress_cells (
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,
  created TEXT GENERATED ALWAYS AS (json_extract(record, '$.created')) VIRTUAL,
  version TEXT GENERATED ALWAYS AS (json_extract(record, '$.version')) VIRTUAL,
  family TEXT GENERATED ALWAYS AS (json_extract(record, '$.family')) VIRTUAL,
  name TEXT GENERATED ALWAYS AS (json_extract(record, '$.case')) VIRTUAL,
  pipeline TEXT GENERATED ALWAYS AS (json_extract(record, '$.pipeline')) VIRTUAL,
  technique TEXT GENERATED ALWAYS AS (json_extract(record, '$.technique')) VIRTUAL,
  size TEXT GENERATED ALWAYS AS (json_extract(record, '$.size')) VIRTUAL,
  measure TEXT GENERATED ALWAYS AS (json_extract(record, '$.measure')) VIRTUAL,
  unit TEXT GENERATED ALWAYS AS (json_extract(record, '$.unit')) VIRTUAL,
  detail TEXT GENERATED ALWAYS AS (json_extract(record, '$.detail')) VIRTUAL,
  explanation TEXT GENERATED ALWAYS AS (json_extract(record, '$.explanation')) VIRTUAL,
  image TEXT GENERATED ALWAYS AS (json_extract(record, '$.image')) VIRTUAL,
  command TEXT GENERATED ALWAYS AS (json_extract(record, '$.command')) VIRTUAL,
  pipeline_hash TEXT GENERATED ALWAYS AS (json_extract(record, '$.pipeline_hash')) VIRTUAL,
  framework TEXT GENERATED ALWAYS AS (json_extract(record, '$.framework')) VIRTUAL,
  device TEXT GENERATED ALWAYS AS (json_extract(record, '$.device')) VIRTUAL,
  driver TEXT GENERATED ALWAYS AS (json_extract(record, '$.driver')) VIRTUAL,
  shader_input TEXT GENERATED ALWAYS AS (json_extract(record, '$.shader_input')) VIRTUAL,
  host TEXT GENERATED ALWAYS AS (json_extract(record, '$.host')) VIRTUAL,
  outcome TEXT GENERATED ALWAYS AS (json_extract(record, '$.outcome')) VIRTUAL,
  value REAL GENERATED ALWAYS AS (json_extract(record, '$.value')) VIRTUAL,
  uncertainty REAL GENERATED ALWAYS AS (json_extract(record, '$.uncertainty')) VIRTUAL,
  limit_value REAL GENERATED ALWAYS AS (json_extract(record, '$.limit')) VIRTUAL,
  seconds REAL GENERATED ALWAYS AS (json_extract(record, '$.seconds')) VIRTUAL,
  record TEXT NOT NULL
);
INSERT INTO stress_cells VALUES(1,'7bda7e3d0d7def486745dd95a1440141','{"created":"2015-10-21 16:29:00 UTC","version":"0.1.0","family":"image_and_camera","case":"case_1","pipeline":"scenes/pipelines/one.pipeline","technique":"one","size":"quick","measure":"RMSE, of the mean","unit":"m","detail":"pass a, port b: 1 NaN","explanation":"the method has no sides","image":"images/a.png","command":"lumivox stress --case a","pipeline_hash":"cafe","framework":"beef","device":"a device","driver":"a driver","shader_input":"spirv","host":"a host","outcome":"biased","value":0.25,"uncertainty":0.5,"limit":0.125,"seconds":1.5,"techniques":{"one":"1+2","two":"3+4"}}');
INSERT INTO stress_cells VALUES(2,'316ce72e8bc70a524d4faee269e63eaf','{"created":"2015-10-21 16:29:00 UTC","version":"0.1.0","family":"geometry","case":"case_3","pipeline":"scenes/pipelines/one.pipeline","technique":"one","size":"quick","measure":"RMSE, of the mean","unit":"m","detail":"pass a, port b: 1 NaN","explanation":"the method has no sides","image":"images/a.png","command":"lumivox stress --case a","pipeline_hash":"cafe","framework":"beef","device":"a device","driver":"a driver","shader_input":"spirv","host":"a host","outcome":"broken","value":0.75,"uncertainty":0.5,"limit":0.125,"seconds":1.5,"techniques":{"one":"1+2","two":"3+4"}}');
CREATE TABLE peak_rates (
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,
  name TEXT GENERATED ALWAYS AS (json_extract(record, '$.name')) VIRTUAL,
  unit TEXT GENERATED ALWAYS AS (json_extract(record, '$.unit')) VIRTUAL,
  median REAL GENERATED ALWAYS AS (json_extract(record, '$.median')) VIRTUAL,
  lower_quartile REAL GENERATED ALWAYS AS (json_extract(record, '$.lower_quartile')) VIRTUAL,
  upper_quartile REAL GENERATED ALWAYS AS (json_extract(record, '$.upper_quartile')) VIRTUAL,
  smallest REAL GENERATED ALWAYS AS (json_extract(record, '$.smallest')) VIRTUAL,
  largest REAL GENERATED ALWAYS AS (json_extract(record, '$.largest')) VIRTUAL,
  repeats INTEGER GENERATED ALWAYS AS (json_extract(record, '$.repeats')) VIRTUAL,
  created TEXT GENERATED ALWAYS AS (json_extract(record, '$.created')) VIRTUAL,
  version TEXT GENERATED ALWAYS AS (json_extract(record, '$.version')) VIRTUAL,
  device TEXT GENERATED ALWAYS AS (json_extract(record, '$.device')) VIRTUAL,
  driver TEXT GENERATED ALWAYS AS (json_extract(record, '$.driver')) VIRTUAL,
  shader_input TEXT GENERATED ALWAYS AS (json_extract(record, '$.shader_input')) VIRTUAL,
  host TEXT GENERATED ALWAYS AS (json_extract(record, '$.host')) VIRTUAL,
  record TEXT NOT NULL
);
INSERT INTO peak_rates VALUES(1,'cb97e0fd890d4aecd51c5e42362e8fc7','{"name":"writes","unit":"writes/s","median":5.0,"lower_quartile":4.0,"upper_quartile":6.0,"smallest":3.0,"largest":7.0,"repeats":3,"created":"2026-01-31 12:00:00 UTC","version":"0.1.0","device":"a device","driver":"a driver","shader_input":"spirv","host":"a host"}');
CREATE INDEX runs_by_scene ON runs (scene_name, pipeline_name);
CREATE INDEX wanted_by_key ON wanted (key);
COMMIT;
