"use strict";
lumivox.show(
  lumivox.h("header", null, lumivox.h("h1", null, "Lumivox voxelizers"),
    lumivox.h("p", { class: "soft" }, "Measured on " + lumivox.data.device + ", by ", lumivox.h("code", null, lumivox.data.command),
      ". The same numbers are in voxels.csv and voxels.json beside this page.")),
  lumivox.h("main", null, lumivox.h("h2", { id: "voxels" }, "Voxels"), voxelSection(lumivox.data.voxels, lumivox.data.scaling)));
