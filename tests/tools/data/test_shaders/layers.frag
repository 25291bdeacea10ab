layout(location = 0) flat in int layerIndex;
layout(location = 0) out float value;
void main() { value = float(layerIndex + 1); }
