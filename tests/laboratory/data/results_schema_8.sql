-- What version 0.1.0 wrote with schema 8, the last before records were kept as JSON, as SQL: a run, one that failed, one without
-- its times, two cells of the stress battery and a peak rate.
PRAGMA application_id = 1280136792;
PRAGMA user_version = 8;
BEGIN TRANSACTION;
CREATE TABLE claims (
  key TEXT PRIMARY KEY,
  machine TEXT NOT NULL,
  process INTEGER NOT NULL,
  started INTEGER NOT NULL,
  command TEXT NOT NULL,
  expires INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
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
INSERT INTO "controls" VALUES(1,'2026-11-25 19:08:12 UTC','frame',12.0,11.5,12.5,5);
INSERT INTO "controls" VALUES(1,'2026-11-25 19:08:12 UTC','next_frame',4.2,4.1,4.3,5);
CREATE TABLE errors (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  output TEXT NOT NULL,
  component TEXT NOT NULL,
  reference TEXT NOT NULL,
  against TEXT NOT NULL,
  seeds INTEGER NOT NULL,
  deterministic INTEGER NOT NULL,
  noise_rmse REAL, per_seed INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
INSERT INTO "errors" VALUES(1,0,'indirect_diffuse','indirect_diffuse','one_bounce_diffuse','bias',2,1,0.0,1);
INSERT INTO "errors" VALUES(3,0,'indirect_diffuse','indirect_diffuse','one_bounce_diffuse','bias',2,1,0.0,1);
CREATE TABLE health (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  finding TEXT NOT NULL,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
INSERT INTO "health" VALUES(1,0,'pass gather, port diffuse: 3 NaN, first at pixel (12, 40)');
INSERT INTO "health" VALUES(2,0,'pass gather, port diffuse: 3 NaN, first at pixel (12, 40)');
INSERT INTO "health" VALUES(3,0,'pass gather, port diffuse: 3 NaN, first at pixel (12, 40)');
CREATE TABLE "images" (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  output TEXT NOT NULL,
  component TEXT NOT NULL,
  reference TEXT NOT NULL,
  flip REAL,
  png BLOB NOT NULL,
  PRIMARY KEY (run, position)
) STRICT;
INSERT INTO "images" VALUES(1,0,'final','full','full',0.25,X'706E67');
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
INSERT INTO "metrics" VALUES(1,0,'bias',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'exposure_ev',-1.25,0.0,NULL);
INSERT INTO "metrics" VALUES(1,0,'flicker',0.25,0.001,NULL);
INSERT INTO "metrics" VALUES(1,0,'flip',0.125,0.001,0.0);
INSERT INTO "metrics" VALUES(1,0,'flip_ldr',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'mean_ratio',0.9,NULL,0.0);
INSERT INTO "metrics" VALUES(1,0,'noise_floor',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'non_finite_image',7.0,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'non_finite_reference',3.0,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'percentile95',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'relative_mse',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'rms_bias',0.51,0.02,3.33333333333333314829e-01);
INSERT INTO "metrics" VALUES(1,0,'rms_noise',NULL,0.0,0.0);
INSERT INTO "metrics" VALUES(1,0,'rmse',1.02,0.0102,3.33333333333333314829e-01);
INSERT INTO "metrics" VALUES(1,0,'ssim',1.0,0.0,1.0);
INSERT INTO "metrics" VALUES(3,0,'bias',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'exposure_ev',-1.25,0.0,NULL);
INSERT INTO "metrics" VALUES(3,0,'flicker',0.25,0.001,NULL);
INSERT INTO "metrics" VALUES(3,0,'flip',0.125,0.001,0.0);
INSERT INTO "metrics" VALUES(3,0,'flip_ldr',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'mean_ratio',0.9,NULL,0.0);
INSERT INTO "metrics" VALUES(3,0,'noise_floor',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'non_finite_image',7.0,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'non_finite_reference',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'percentile95',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'relative_mse',0.0,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'rms_bias',1.51,0.02,3.33333333333333314829e-01);
INSERT INTO "metrics" VALUES(3,0,'rms_noise',NULL,0.0,0.0);
INSERT INTO "metrics" VALUES(3,0,'rmse',3.02,0.0302,3.33333333333333314829e-01);
INSERT INTO "metrics" VALUES(3,0,'ssim',1.0,0.0,1.0);
CREATE TABLE notes (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  note TEXT NOT NULL,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
INSERT INTO "notes" VALUES(1,0,'6 of 8 layers were used');
CREATE TABLE parameters (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  name TEXT NOT NULL,
  value TEXT NOT NULL,
  PRIMARY KEY (run, name)
) STRICT, WITHOUT ROWID;
INSERT INTO "parameters" VALUES(1,'cones','1');
INSERT INTO "parameters" VALUES(1,'distribution','cosine');
INSERT INTO "parameters" VALUES(2,'cones','2');
INSERT INTO "parameters" VALUES(2,'distribution','cosine');
INSERT INTO "parameters" VALUES(3,'cones','3');
INSERT INTO "parameters" VALUES(3,'distribution','cosine');
CREATE TABLE passes (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  position INTEGER NOT NULL,
  name TEXT NOT NULL,
  PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
INSERT INTO "passes" VALUES(1,0,'gbuffer');
INSERT INTO "passes" VALUES(1,1,'gather');
INSERT INTO "passes" VALUES(2,0,'gbuffer');
INSERT INTO "passes" VALUES(2,1,'gather');
INSERT INTO "passes" VALUES(3,0,'gbuffer');
INSERT INTO "passes" VALUES(3,1,'gather');
CREATE TABLE "peak_rates" (
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
INSERT INTO "peak_rates" VALUES('a device','a driver','spirv','a host','writes','writes/s','2026-01-31 12:00:00 UTC','0.1.0',5.0,4.0,6.0,3.0,7.0,3);
CREATE TABLE provenance (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  kind TEXT NOT NULL,
  name TEXT NOT NULL,
  hash TEXT NOT NULL,
  PRIMARY KEY (run, kind, name)
) STRICT, WITHOUT ROWID;
INSERT INTO "provenance" VALUES(1,'display','exposure -1.5, tone filmic','');
INSERT INTO "provenance" VALUES(1,'flicker','4 pairs','');
INSERT INTO "provenance" VALUES(1,'framework','lumivox','f0');
INSERT INTO "provenance" VALUES(1,'kept','light.radiance','');
INSERT INTO "provenance" VALUES(1,'kept','voxels.fragments','');
INSERT INTO "provenance" VALUES(1,'not_counted','only this pass','');
INSERT INTO "provenance" VALUES(1,'pipeline','scenes/pipelines/voxel_cone_tracing.pipeline','919e');
INSERT INTO "provenance" VALUES(1,'scene','scenes/cornell.scene','5ce');
INSERT INTO "provenance" VALUES(1,'technique','voxel_cone_tracing','1a');
INSERT INTO "provenance" VALUES(1,'technique','voxelization','2b');
INSERT INTO "provenance" VALUES(2,'display','exposure -1.5, tone filmic','');
INSERT INTO "provenance" VALUES(2,'flicker','4 pairs','');
INSERT INTO "provenance" VALUES(2,'framework','lumivox','f0');
INSERT INTO "provenance" VALUES(2,'kept','light.radiance','');
INSERT INTO "provenance" VALUES(2,'kept','voxels.fragments','');
INSERT INTO "provenance" VALUES(2,'not_counted','only this pass','');
INSERT INTO "provenance" VALUES(2,'pipeline','scenes/pipelines/voxel_cone_tracing.pipeline','919e');
INSERT INTO "provenance" VALUES(2,'scene','scenes/cornell.scene','5ce');
INSERT INTO "provenance" VALUES(2,'technique','voxel_cone_tracing','1a');
INSERT INTO "provenance" VALUES(2,'technique','voxelization','2b');
INSERT INTO "provenance" VALUES(3,'display','exposure -1.5, tone filmic','');
INSERT INTO "provenance" VALUES(3,'flicker','4 pairs','');
INSERT INTO "provenance" VALUES(3,'framework','lumivox','f0');
INSERT INTO "provenance" VALUES(3,'kept','light.radiance','');
INSERT INTO "provenance" VALUES(3,'kept','voxels.fragments','');
INSERT INTO "provenance" VALUES(3,'not_counted','only this pass','');
INSERT INTO "provenance" VALUES(3,'pipeline','scenes/pipelines/voxel_cone_tracing.pipeline','919e');
INSERT INTO "provenance" VALUES(3,'scene','scenes/cornell.scene','5ce');
INSERT INTO "provenance" VALUES(3,'technique','voxel_cone_tracing','1a');
INSERT INTO "provenance" VALUES(3,'technique','voxelization','2b');
CREATE TABLE reports (
  id INTEGER PRIMARY KEY,
  points TEXT NOT NULL,
  command TEXT NOT NULL,
  machine TEXT NOT NULL,
  process INTEGER NOT NULL,
  started INTEGER NOT NULL,
  expires INTEGER NOT NULL
) STRICT;
CREATE TABLE resources (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  what TEXT NOT NULL,
  pass TEXT NOT NULL,
  bytes INTEGER NOT NULL,
  PRIMARY KEY (run, what, pass)
) STRICT, WITHOUT ROWID;
INSERT INTO "resources" VALUES(1,'pass','gather',1048576);
INSERT INTO "resources" VALUES(1,'peak','',21474836480);
INSERT INTO "resources" VALUES(2,'pass','gather',1048576);
INSERT INTO "resources" VALUES(2,'peak','',21474836480);
INSERT INTO "resources" VALUES(3,'pass','gather',1048576);
INSERT INTO "resources" VALUES(3,'peak','',21474836480);
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
  reference_samples INTEGER NOT NULL,
  device TEXT NOT NULL,
  driver TEXT NOT NULL,
  shader_input TEXT NOT NULL,
  host TEXT NOT NULL,
  framework_share REAL,
  failure TEXT NOT NULL,
  command TEXT NOT NULL
, complete INTEGER NOT NULL DEFAULT 1) STRICT;
INSERT INTO "runs" VALUES(1,'1b179f5a72f0d15e64a7282ff4f8f4b8','2026-01-31 12:00:00 UTC','0.1.0','scenes/cornell.scene','Cornell box','scenes/pipelines/voxel_cone_tracing.pipeline','Voxel cone tracing','quality',1,'main',0.1,64,48,-1,1,1,1,37,'a device, ''quoted''','','','a host',NULL,'','lumivox report scenes/cornell.scene',1);
INSERT INTO "runs" VALUES(2,'a5a1f1070884105c3f4ef2ba6a7468ef','2026-01-31 12:00:00 UTC','0.1.0','scenes/cornell.scene','Cornell box','scenes/pipelines/voxel_cone_tracing.pipeline','Voxel cone tracing','quality',1,'main',0.1,64,48,-1,1,1,1,0,'a device, ''quoted''','','','a host',NULL,'it did not fit','lumivox report scenes/cornell.scene',1);
INSERT INTO "runs" VALUES(3,'bcc2577ef4d4fdc939622c27f94ef1bb','2026-01-31 12:00:00 UTC','0.1.0','scenes/cornell.scene','Cornell box','scenes/pipelines/voxel_cone_tracing.pipeline','Voxel cone tracing','quality',1,'main',0.1,64,48,-1,1,1,1,0,'a device, ''quoted''','','','a host',NULL,'','lumivox report scenes/cornell.scene',0);
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
  image TEXT NOT NULL,
  command TEXT NOT NULL,
  seconds REAL NOT NULL,
  pipeline_hash TEXT NOT NULL,
  framework TEXT NOT NULL,
  device TEXT NOT NULL,
  driver TEXT NOT NULL,
  shader_input TEXT NOT NULL,
  host TEXT NOT NULL
) STRICT;
INSERT INTO "stress_cells" VALUES(1,'7bda7e3d0d7def486745dd95a1440141','2015-10-21 16:29:00 UTC','0.1.0','image_and_camera','case_1','scenes/pipelines/one.pipeline','one','quick','biased','RMSE, of the mean','m',0.25,0.5,0.125,'pass a, port b: 1 NaN','the method has no sides','images/a.png','lumivox stress --case a',1.5,'cafe','beef','a device','a driver','spirv','a host');
INSERT INTO "stress_cells" VALUES(2,'316ce72e8bc70a524d4faee269e63eaf','2015-10-21 16:29:00 UTC','0.1.0','geometry','case_3','scenes/pipelines/one.pipeline','one','quick','broken','RMSE, of the mean','m',0.75,0.5,0.125,'pass a, port b: 1 NaN','the method has no sides','images/a.png','lumivox stress --case a',1.5,'cafe','beef','a device','a driver','spirv','a host');
CREATE TABLE stress_provenance (
  cell INTEGER NOT NULL REFERENCES stress_cells ON DELETE CASCADE,
  technique TEXT NOT NULL,
  hash TEXT NOT NULL,
  PRIMARY KEY (cell, technique)
) STRICT, WITHOUT ROWID;
INSERT INTO "stress_provenance" VALUES(1,'one','1+2');
INSERT INTO "stress_provenance" VALUES(1,'two','3+4');
INSERT INTO "stress_provenance" VALUES(2,'one','1+2');
INSERT INTO "stress_provenance" VALUES(2,'two','3+4');
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
INSERT INTO "timings" VALUES(1,'frame','',10.0,9.5,10.5,9.0,12.0,5);
INSERT INTO "timings" VALUES(1,'moved_frame','',6.0,5.9,6.1,5.8,7.0,5);
INSERT INTO "timings" VALUES(1,'next_frame','',4.0,3.9,4.1,3.8,5.0,5);
INSERT INTO "timings" VALUES(1,'pass_device','gather',6.0,5.9,6.1,5.8,6.4,5);
INSERT INTO "timings" VALUES(1,'pass_host','gather',6.5,6.4,6.6,6.3,6.9,5);
INSERT INTO "timings" VALUES(1,'still_frame','',1.0,0.9,1.1,0.8,2.0,5);
INSERT INTO "timings" VALUES(2,'frame','',10.0,9.5,10.5,9.0,12.0,5);
INSERT INTO "timings" VALUES(2,'moved_frame','',6.0,5.9,6.1,5.8,7.0,5);
INSERT INTO "timings" VALUES(2,'next_frame','',4.0,3.9,4.1,3.8,5.0,5);
INSERT INTO "timings" VALUES(2,'pass_device','gather',6.0,5.9,6.1,5.8,6.4,5);
INSERT INTO "timings" VALUES(2,'pass_host','gather',6.5,6.4,6.6,6.3,6.9,5);
INSERT INTO "timings" VALUES(2,'still_frame','',1.0,0.9,1.1,0.8,2.0,5);
INSERT INTO "timings" VALUES(3,'frame','',10.0,9.5,10.5,9.0,12.0,5);
INSERT INTO "timings" VALUES(3,'moved_frame','',6.0,5.9,6.1,5.8,7.0,5);
INSERT INTO "timings" VALUES(3,'next_frame','',4.0,3.9,4.1,3.8,5.0,5);
INSERT INTO "timings" VALUES(3,'pass_device','gather',6.0,5.9,6.1,5.8,6.4,5);
INSERT INTO "timings" VALUES(3,'pass_host','gather',6.5,6.4,6.6,6.3,6.9,5);
INSERT INTO "timings" VALUES(3,'still_frame','',1.0,0.9,1.1,0.8,2.0,5);
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
INSERT INTO "voxels" VALUES(1,'voxels.fragments','VoxelFragments','',32,16,8,103,100,7,80,20,20,400,10,300,3,0.8,0.8);
INSERT INTO "voxels" VALUES(3,'voxels.fragments','VoxelFragments','',32,16,8,103,100,7,80,20,20,400,10,300,3,0.8,0.8);
CREATE TABLE wanted (
  report INTEGER NOT NULL REFERENCES reports ON DELETE CASCADE,
  key TEXT NOT NULL,
  PRIMARY KEY (report, key)
) STRICT, WITHOUT ROWID;
CREATE TABLE work (
  run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
  pass TEXT NOT NULL,
  name TEXT NOT NULL,
  amount REAL NOT NULL,
  PRIMARY KEY (run, pass, name)
) STRICT, WITHOUT ROWID;
INSERT INTO "work" VALUES(1,'gather','buffer_reads',1000000000000.0);
INSERT INTO "work" VALUES(1,'gather','texture_samples_d3_rgba16f_mips',3.0);
INSERT INTO "work" VALUES(1,'gbuffer','draws',1.0);
INSERT INTO "work" VALUES(2,'gather','buffer_reads',1000000000000.0);
INSERT INTO "work" VALUES(2,'gather','texture_samples_d3_rgba16f_mips',3.0);
INSERT INTO "work" VALUES(2,'gbuffer','draws',1.0);
INSERT INTO "work" VALUES(3,'gather','buffer_reads',1000000000000.0);
INSERT INTO "work" VALUES(3,'gather','texture_samples_d3_rgba16f_mips',3.0);
INSERT INTO "work" VALUES(3,'gbuffer','draws',1.0);
CREATE INDEX runs_by_scene ON runs (scene_name, pipeline_name);
CREATE INDEX wanted_by_key ON wanted (key);
COMMIT;
