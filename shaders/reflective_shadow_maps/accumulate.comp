#version 450
// Running sum over the rows, in their order, so that it is the same in every run.
layout(local_size_x = 1) in;

layout(std140, binding = 0) uniform Parameters {
  int firstRow;
  int rows;  // of this dispatch
};
layout(std430, binding = 0) buffer Rows { float cumulative[]; };

void main() {
  // Summed with the lost low part carried along (Kahan 1965): the rows of dim lights count too.
  float sum = 0.0, lost = 0.0;
  if (firstRow > 0) sum = cumulative[firstRow - 1];
  for (int row = firstRow; row < firstRow + rows; ++row) {
    float addend = cumulative[row] - lost;
    float next = sum + addend;
    lost = (next - sum) - addend;
    sum = next;
    cumulative[row] = sum;
  }
}
