// Histogram of the depths of a view, in bins of equal width, for intervals with equal numbers of texels.
const int kBins = 256;

layout(std430, binding = 0) readonly buffer Ranges { uint ranges[]; };  // two per view: layers_range.comp

bool isEmpty(int view) { return ranges[2 * view] == 0xffffffffu && ranges[2 * view + 1] == 0xffffffffu; }
float lowestOf(int view) { return fromOrder(ranges[2 * view]); }
float highestOf(int view) { return fromOrder(~ranges[2 * view + 1]); }
