#version 450
#pragma lumivox axis SHAPE whole small
layout(location = 0) out vec4 filled;
void main() { filled = vec4(0.25, 0.5, 0.75, 1.0); }
