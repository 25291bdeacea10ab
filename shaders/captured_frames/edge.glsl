const float kEdge = 0.05;  // of the depth: neighbours farther apart are not one surface
