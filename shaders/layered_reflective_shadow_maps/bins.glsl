// Depths of a view in bins of equal width, by which its intervals get as many texels each.
const int kBins = 256;

layout(std430, binding = 0) readonly buffer Ranges { uvec2 ranges[]; };

bool isEmpty(int view) { return ranges[view].x == 0xffffffffu && ranges[view].y == 0xffffffffu; }
float lowestOf(int view) { return fromOrder(ranges[view].x); }
float highestOf(int view) { return fromOrder(~ranges[view].y); }
