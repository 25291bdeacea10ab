// Depths of a view in bins of equal width, by which its intervals get as many texels each.
const int kBins = 256;

layout(std430, binding = 0) readonly buffer Ranges { uint ranges[]; };  // two of a view: layers_range.comp

bool isEmpty(int view) { return ranges[2 * view] == 0xffffffffu && ranges[2 * view + 1] == 0xffffffffu; }
float lowestOf(int view) { return fromOrder(ranges[2 * view]); }
float highestOf(int view) { return fromOrder(~ranges[2 * view + 1]); }
